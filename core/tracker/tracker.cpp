// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/tracker.hpp"

#include <cmath>
#include <utility>

#include "core/reach.hpp"
#include "core/tracker/feet.hpp"
#include "core/tracker/gesture.hpp"
#include "core/tracker/key_poses.hpp"
#include "core/tracker/magnetic.hpp"
#include "core/tracker/sitting.hpp"
#include "core/tracker/slip.hpp"
#include "core/tracker/stance.hpp"
#include "core/tracker/traces.hpp"

namespace kinemap {

class Tracker::Impl {
 public:
  explicit Impl(const TrackerConfig& config)
      : ball_height_m_(config.stance.ball_height_m),
        key_poses_(config.key_poses),
        stance_(config.stance),
        slip_(config.slip),
        magnetic_(config.magnetic),
        gesture_(config.gesture),
        traces_(config.traces, config.pivot),
        sitting_(config.sitting) {}

  void step(const SuitFrame& frame, std::vector<Event>& events) {
    ++stats_.frames;
    if (frame.discontinuity) restart(frame, events);
    last_frame_s_ = frame.time_s;
    const auto soles = soles_of(frame, ball_height_m_);

    put(sitting_.step(frame, soles), events);
    put(traces_.step(frame.time_s, gesture_.step(frame)), events);
    auto p_pelvis_stance = stance_.step(frame, soles);
    if (sitting_.legs_sit()) p_pelvis_stance.reset();

    const bool busy = traces_.open() || sitting_.open();
    const bool now = traces_.starting() || sitting_.starting();
    const auto key_pose =
        key_poses_.step(frame, {busy, now}, p_pelvis_stance, magnetic_.step(frame), slip_.step(frame, soles));
    if (key_pose) slip_.begin();
    put(key_pose, events);
    if (traces_.open()) traces_.record(frame, key_poses_.latest());
    sitting_.record(frame, key_poses_.latest());
    count();
  }

  void resume(const Interrupted& before, double unseen_path_m) {
    key_poses_.resume(before, unseen_path_m);
    if (before.trace) gesture_.resume(before.trace->hips);
    traces_.resume(before);
    sitting_.resume(before);
  }

  std::optional<UnfinishedTrace> take_unfinished_trace() { return traces_.take_unfinished(gesture_.hips()); }
  std::optional<UnfinishedSitting> take_unfinished_sitting() { return sitting_.take_unfinished(); }
  [[nodiscard]] SinceKeyPose since_key_pose() const { return key_poses_.since_latest(); }

  void finish(std::vector<Event>& events) {
    put(sitting_.close(), events);
    put(traces_.close(), events);
    put(key_poses_.finish(), events);
    count();
  }

  [[nodiscard]] const TrackerStats& stats() const { return stats_; }

 private:
  void restart(const SuitFrame& frame, std::vector<Event>& events) {
    const double unseen_s = frame.time_s - last_frame_s_;
    const Pose& T_odom_pelvis = frame[Segment::Pelvis];
    const Pose T_odom_before = T_odom_pelvis * stayed(key_poses_.newest(), T_odom_pelvis).inverse();
    const bool goes_on = unseen_s < kJump || (unseen_s < kPause && traces_.waited(T_odom_before, frame));
    put(sitting_.reset(), events);
    if (!goes_on) put(traces_.close(), events);
    if (!goes_on) gesture_.reset();
    put(key_poses_.finish(), events);  // the last that is known before the break
    if (goes_on) traces_.move(T_odom_before, unseen_s);
    stance_.reset();
    slip_.reset();
    slip_.begin();
    magnetic_.reset();
  }

  void put(std::optional<Event>&& event, std::vector<Event>& events) {
    if (!event) return;
    stats_.key_poses += std::holds_alternative<KeyPose>(*event);
    stats_.traces += std::holds_alternative<Trace>(*event);
    stats_.pivots += std::holds_alternative<Pivot>(*event);
    stats_.sittings += std::holds_alternative<Sitting>(*event);
    events.push_back(std::move(*event));
  }

  void count() {
    stats_.tracing = traces_.held();
    stats_.traces_rejected = traces_.rejected();
    stats_.contacts_thinned_out = traces_.thinned_out();
    stats_.path_m = key_poses_.total_path_m();
  }

  /// s: in so short a break the body stays and only the suit's world moves; a gesture, which is inside the body, goes
  /// on.
  static constexpr double kJump = 0.1;
  /// s: over so long a break it goes on when the hand is where it was beside the body: the wearer has waited.
  static constexpr double kPause = 3.0;

  double ball_height_m_;
  KeyPoseFold key_poses_;
  StanceFold stance_;
  SlipFold slip_;
  MagneticFold magnetic_;
  GestureFold gesture_;
  TraceFold traces_;
  SittingFold sitting_;
  double last_frame_s_ = -HUGE_VAL;
  TrackerStats stats_;
};

Tracker::Tracker(const TrackerConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::resume(const Interrupted& before, double unseen_path_m) { impl_->resume(before, unseen_path_m); }
std::optional<UnfinishedTrace> Tracker::take_unfinished_trace() { return impl_->take_unfinished_trace(); }
std::optional<UnfinishedSitting> Tracker::take_unfinished_sitting() { return impl_->take_unfinished_sitting(); }
SinceKeyPose Tracker::since_key_pose() const { return impl_->since_key_pose(); }
void Tracker::step(const SuitFrame& frame, std::vector<Event>& events) { impl_->step(frame, events); }
void Tracker::finish(std::vector<Event>& events) { impl_->finish(events); }
const TrackerStats& Tracker::stats() const { return impl_->stats(); }

}  // namespace kinemap
