// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/batch.hpp"

#include <chrono>
#include <vector>

#include "core/mapper/mapper.hpp"

namespace kinemap::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time until it is destroyed to `total_s`; for figures only, nothing is decided by it.
class Stopwatch {
 public:
  explicit Stopwatch(double& total_s) : total_s_(total_s), begin_(Clock::now()) {}
  ~Stopwatch() { total_s_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_s_;
  Clock::time_point begin_;
};

void map_events(Mapper& mapper, std::vector<Event>& events, double& map_s) {
  if (events.empty()) return;
  const Stopwatch watch(map_s);
  for (const Event& event : events) mapper.add(event);
  events.clear();
}

}  // namespace

Result<BatchResult> build_map(const std::string& recording, const Config& config, const Progress& progress,
                              const Observer& observer) {
  return build_map(std::vector{recording}, config, progress, observer);
}

Result<BatchResult> build_map(const std::vector<std::string>& recordings, const Config& config,
                              const Progress& progress, const Observer& observer) {
  Tracker tracker(config.tracker);
  Mapper mapper(config.mapper);
  std::vector<Event> events;
  StageTimes times;
  double all_s = 0.0;

  const RecordingSink sink{.on_frame =
                               [&](const SuitFrame& frame) {
                                 {
                                   const Stopwatch watch(times.track_s);
                                   tracker.step(frame, events);
                                 }
                                 map_events(mapper, events, times.map_s);
                                 if (observer) observer(frame, *mapper.snapshot());
                               },
                           .on_wearer = [&](const WearerInfo& wearer) { mapper.set_wearer(wearer); }};
  const auto summary = [&] {
    const Stopwatch watch(all_s);
    return read_recordings(recordings, config.stream, sink, progress);
  }();
  if (!summary) return Error{summary.error()};
  times.read_s = all_s - times.track_s - times.map_s;

  tracker.finish(events);
  map_events(mapper, events, times.map_s);
  {
    const Stopwatch watch(times.map_s);
    mapper.finish();
  }
  return BatchResult{*summary, tracker.stats(), mapper.snapshot(), times};
}

}  // namespace kinemap::cli
