// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>

#include <array>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/mapper/mapper.hpp"
#include "core/tracker/tracker.hpp"
#include "daemon/realtime.hpp"
#include "protocol/json_text.hpp"
#include "protocol/recording.hpp"
#include "tools/bench/commands.hpp"
#include "tools/bench/scenario.hpp"
#include "tools/bench/temporary_directory.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kTurns = 4;

struct Options {
  std::string recording;
  double seconds = 60.0;
  double rate_hz = 120.0;
  bool idle = false;
  int load = 0;      ///< threads that never rest
  int realtime = 0;  ///< every other turn with this real-time priority; 0: none
  bool json = false;
};

Result<std::vector<SuitFrame>> read_frames(const std::string& recording) {
  std::vector<SuitFrame> frames;
  const RecordingSink sink{.on_frame = [&](const SuitFrame& frame) { frames.push_back(frame); },
                           .on_wearer = [](const WearerInfo&) {}};
  const auto summary = read_recording(recording, {}, sink);
  if (!summary) return Error{summary.error()};
  return frames;
}

/// Builds the map of the session over and over, as a solver that never rests; counts the optimisations.
class BusySolver {
 public:
  explicit BusySolver(const std::vector<SuitFrame>& frames) {
    Tracker tracker{TrackerConfig{}};
    for (const SuitFrame& frame : frames) tracker.step(frame, events_);
    tracker.finish(events_);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) build(stop);
    });
  }
  [[nodiscard]] std::size_t optimisations() const { return optimisations_; }

 private:
  void build(const std::stop_token& stop) {
    Mapper mapper{MapperConfig{}};
    for (const Event& event : events_) {
      if (stop.stop_requested()) return;
      mapper.add(event);
    }
    mapper.finish();
    optimisations_ += mapper.snapshot()->graph.optimisations;
  }
  std::vector<Event> events_;
  std::atomic<std::size_t> optimisations_ = 0;
  std::jthread thread_;  // last: joined first
};

struct Latencies {
  std::vector<double> step_us;  ///< how long the step took
  std::vector<double> late_us;  ///< how late it began: the scheduler's part
};

/// Threads that never rest.
class Load {
 public:
  explicit Load(int threads) {
    for (int i = 0; i < threads; ++i)
      threads_.emplace_back([](const std::stop_token& stop) {
        while (!stop.stop_requested()) continue;
      });
  }

 private:
  std::vector<std::jthread> threads_;
};

/// Steps at the suit's pace for one turn; the recording begins anew when it ends.
void measure(const std::vector<SuitFrame>& frames, const Options& options, Latencies& result) {
  const auto steps = static_cast<std::size_t>(options.seconds / kTurns * options.rate_hz);
  result.step_us.reserve(kTurns * steps);
  result.late_us.reserve(kTurns * steps);
  Tracker tracker{TrackerConfig{}};
  std::vector<Event> events;
  events.reserve(64);
  cli::ProgressBar bar("tracker");
  const auto begin = Clock::now();
  const auto microseconds = [](Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  for (std::size_t i = 0; i < steps; ++i) {
    const auto due = begin + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(static_cast<double>(i) / options.rate_hz));
    std::this_thread::sleep_until(due);
    if (i > 0 && i % frames.size() == 0) tracker = Tracker{TrackerConfig{}};
    const auto from = Clock::now();
    tracker.step(frames[i % frames.size()], events);
    const auto to = Clock::now();
    result.step_us.push_back(microseconds(to - from));
    result.late_us.push_back(microseconds(from - due));
    events.clear();
    bar.update(static_cast<double>(i) / static_cast<double>(steps));
  }
}

/// In turns, so that what else the machine does falls on both alike: without and, if asked for, with real-time
/// priority.
Result<std::array<Latencies, 2>> measure_in_turns(const std::vector<SuitFrame>& frames, const Options& options) {
  std::array<Latencies, 2> result;
  std::string refusal;
  for (int turn = 0; turn < kTurns; ++turn) {
    for (const bool realtime : {false, true}) {
      if (realtime && options.realtime == 0) continue;
      std::jthread([&, realtime] {
        if (realtime) refusal = set_realtime(::pthread_self(), options.realtime);
        measure(frames, options, result[realtime]);
      }).join();
    }
    if (!refusal.empty()) return Error{refusal};
  }
  return result;
}

int tracker(const Options& options) {
  const TemporaryDirectory directory;
  const auto scenario = make_scenario(directory.path(), options.recording);
  if (!scenario) return cli::fail("tracker", scenario.error());
  const auto frames = read_frames(scenario->recording);
  if (!frames) return cli::fail("tracker", frames.error());
  std::optional<BusySolver> solver;
  if (!options.idle) solver.emplace(*frames);
  std::optional<Load> load(std::in_place, options.load);
  auto latencies = measure_in_turns(*frames, options);
  load.reset();
  const std::size_t optimisations = solver ? solver->optimisations() : 0;
  solver.reset();

  if (!latencies) return cli::fail("tracker", latencies.error());

  const std::pair<const char*, double> ranks[] = {{"50", 0.5}, {"99", 0.99}, {"99.9", 0.999}, {"100", 1.0}};
  nlohmann::ordered_json json = {
      {"scenario", scenario->name},   {"rate_hz", options.rate_hz},   {"steps", (*latencies)[0].step_us.size()},
      {"solver_busy", !options.idle}, {"load_threads", options.load}, {"optimisations_meanwhile", optimisations}};
  std::string text = format(
      "%s; %zu steps at %.0f Hz, %s, %d busy threads\n\n| priority | percentile | step µs | begun late by µs "
      "|\n|---|---|---|---|\n",
      scenario->name.c_str(), (*latencies)[0].step_us.size(), options.rate_hz,
      options.idle ? "no solver" : format("the solver made %zu optimisations meanwhile", optimisations).c_str(),
      options.load);
  for (const bool realtime : {false, true}) {
    auto& [step_us, late_us] = (*latencies)[realtime];
    if (step_us.empty()) continue;
    const std::string priority = realtime ? "real-time " + std::to_string(options.realtime) : "ordinary";
    for (const auto& [name, part] : ranks) {
      const double step = percentile(step_us, part), late = percentile(late_us, part);
      text += format("| %s | %s | %.1f | %.1f |\n", priority.c_str(), name, step, late);
      json[priority]["step_us"][name] = step;
      json[priority]["late_us"][name] = late;
    }
  }
  return cli::print("tracker", options.json ? pretty_text(json) : text);
}

}  // namespace

void add_tracker(CLI::App& app, cli::Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = cli::add_command(
      app, run, "tracker", "Latency of a tracker step at the suit's rate while the solver runs in another thread",
      "  bench tracker\n  bench tracker --seconds 300\n  bench tracker --idle       without the solver\n  bench "
      "tracker --load 4 --realtime 10\n",
      options, tracker);
  command->add_option("--recording", options->recording, "Default: a simulated session of about six minutes")
      ->type_name("FILE");
  command->add_option("--seconds", options->seconds, "How long")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 86400.0));
  command->add_option("--rate", options->rate_hz, "Steps a second")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 10000.0));
  command->add_option("--load", options->load, "So many more threads that never rest")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  command->add_option("--realtime", options->realtime, "Every other turn with this real-time priority (SCHED_FIFO)")
      ->check(CLI::Range(1, 99));
  command->add_flag("--idle", options->idle, "Leave the solver out");
  command->add_flag("--json", options->json, "Print the figures as JSON");
}

}  // namespace kinemap::bench
