// SPDX-License-Identifier: Apache-2.0
#include "daemon/resume.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/timeline.hpp"

namespace kinemap {
namespace {

constexpr double kLongestS = 12 * 3600.0;
constexpr double kClockS = 30.0;  // wall clock against counter: buffers, a paused sender, a clock that is being set
constexpr double kClockShare = 0.01;
constexpr double kRightThereS = 10.0;  // the mark is a second old, and what was sent to a daemon that starts is lost
constexpr double kTimeCodeS = 0.5;     // time code against counter, both of the suit
constexpr double kForgottenS = 10.0;   // more than any gap in a gesture
constexpr double kSpeed = 3.0;         // m/s that a person in a suit walks or runs at most, over minutes
constexpr double kStep = 1.0;          // m

/// What the entries leave unfinished.
class Unfinished {
 public:
  void add(const KeyPose& key_pose) {
    if (key_pose.discontinuity) end();
    // Key poses come every second while a gesture lasts: it has ended long ago, and came to nothing.
    if (all_.trace && key_pose.time_s > all_.trace->seen_s + kForgottenS) all_.trace.reset();
    if (all_.sitting && key_pose.time_s > all_.sitting->seen_s + kForgottenS) all_.sitting.reset();
    all_.key_poses.push_back(key_pose);
    forget();
  }
  void add(const Trace&) { all_.trace.reset(); }
  void add(const Pivot&) { all_.trace.reset(); }
  void add(const Sitting&) { all_.sitting.reset(); }
  void add(const journal::StreamSilence&) { end(); }
  void add(const UnfinishedTrace& piece) { append(all_.trace, piece); }
  void add(const UnfinishedSitting& piece) { append(all_.sitting, piece); }
  template <class Other>
  void add(const Other&) {}

  [[nodiscard]] Interrupted take() { return std::move(all_); }

 private:
  void end() {
    all_.trace.reset();
    all_.sitting.reset();
  }
  /// Key poses to which nothing refers any more. Now and then, for it takes time.
  void forget() {
    auto& key_poses = all_.key_poses;
    if (key_poses.size() < 2 * kept_ + 64) return;
    KeyPoseId first = key_poses.back().id;
    if (all_.trace && !all_.trace->contacts.empty()) first = std::min(first, all_.trace->contacts.front().key_pose);
    if (all_.sitting && !all_.sitting->samples.empty()) first = std::min(first, all_.sitting->samples.front().key_pose);
    std::erase_if(key_poses, [&](const KeyPose& k) { return k.id < first; });
    kept_ = key_poses.size();
  }

  Interrupted all_;
  std::size_t kept_ = 0;
};

}  // namespace

double ResumePoint::seen_s() const { return std::max(mark.time_s, tracker.key_poses.back().time_s); }

const Pose& ResumePoint::T_odom_pelvis() const {
  return tracker.since_key_pose ? tracker.since_key_pose->T_odom_pelvis : tracker.key_poses.back().T_odom_pelvis;
}

std::optional<ResumePoint> resume_point(const std::vector<journal::Entry>& entries) {
  Unfinished unfinished;
  const journal::StreamMark* before = nullptr;
  const journal::StreamMark* mark = nullptr;
  for (const auto& entry : entries) {
    std::visit([&](const auto& e) { unfinished.add(e); }, entry);
    if (const auto* m = std::get_if<journal::StreamMark>(&entry)) before = std::exchange(mark, m);
  }
  Interrupted tracker = unfinished.take();
  if (tracker.key_poses.empty() || before == nullptr) return std::nullopt;
  const auto steps = static_cast<std::int32_t>(static_cast<std::uint32_t>(mark->index - before->index));
  const double seconds = mark->time_s - before->time_s;
  if (steps <= 0 || seconds <= 0.0) return std::nullopt;
  if (mark->T_odom_pelvis && mark->time_s >= tracker.key_poses.back().time_s)
    tracker.since_key_pose = {*mark->T_odom_pelvis, mark->path_m.value_or(0.0), mark->turn_rad.value_or(0.0)};
  return ResumePoint{std::move(tracker), *mark, steps / seconds};
}

std::optional<double> time_since(const ResumePoint& point, const SuitFrame& frame, std::int64_t unix_ms) {
  // The counter has 32 bits; one that begins anew is behind, and behind is nearly a whole turn ahead.
  const auto steps = static_cast<std::uint32_t>(frame.counter - point.mark.index);
  const double counted_s = steps / point.rate_hz;
  const double clock_s = static_cast<double>(unix_ms - point.mark.unix_ms) / 1000.0;
  if (counted_s > kLongestS) return std::nullopt;
  double since_s = counted_s;
  if (clock_s > counted_s + kClockS + kClockShare * counted_s) {
    if (counted_s > kRightThereS) return std::nullopt;
    const auto code = point.mark.time_code_ms;
    const bool held = code && std::abs(time_code_step_s(*code, frame.time_code_ms) - counted_s) < kTimeCodeS;
    if (!held) since_s = clock_s;
  }
  const Eigen::Vector3d walked = frame[Segment::Pelvis].p - point.T_odom_pelvis().p;
  if (walked.head<2>().norm() > kStep + kSpeed * since_s) return std::nullopt;
  return since_s;
}

}  // namespace kinemap
