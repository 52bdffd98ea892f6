// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/gesture.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

using Eigen::Vector3d;

struct Arm {
  Segment upper_arm, forearm, hand, upper_leg;
  double outward;  // sign of y on this side
};
constexpr Arm kLeft{Segment::LeftUpperArm, Segment::LeftForearm, Segment::LeftHand, Segment::LeftUpperLeg, 1.0};
constexpr Arm kRight{Segment::RightUpperArm, Segment::RightForearm, Segment::RightHand, Segment::RightUpperLeg, -1.0};

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Between upper arm and forearm.
double elbow_angle(const SuitFrame& frame, const Arm& arm) {
  const Vector3d& elbow = frame[arm.forearm].p;
  return angle_between(frame[arm.upper_arm].p - elbow, frame[arm.hand].p - elbow);
}

double distance_to_segment(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const double along = (point - a).dot(b - a) / (b - a).squaredNorm();
  return (point - a - std::clamp(along, 0.0, 1.0) * (b - a)).norm();
}

// The right hand draws beside its hip now and then, wrist at the crest and fingers forward. So it must prove harder
// that it lies there: with its palm.
TrackerConfig::Gesture second_hand(TrackerConfig::Gesture config) {
  config.hold_s = config.both_hold_s;
  config.elbow_off_rad = config.elbow_on_rad;
  config.hip_on_m = config.hip_off_m = config.both_hip_m;
  config.below_hip_off_m = config.below_hip_on_m;
  config.outside_hip_off_m = config.outside_hip_on_m;
  return config;
}

}  // namespace

HandOnHip::HandOnHip(Side side, const TrackerConfig::Gesture& config)
    : side_(side), config_(config), speed_(config.velocity_smoothing_s, config.speed_smoothing_s) {}

HipState HandOnHip::step(const SuitFrame& frame) {
  const Segment hand = (side_ == Side::Left ? kLeft : kRight).hand;
  const double speed = speed_.step(frame.time_s, frame[Segment::Pelvis].inverse() * frame[hand].p);
  const bool was_near = state_.near;
  state_.near = is_near(frame);
  if (!was_near || (!state_.held && speed > config_.rest_speed_mps)) state_.rests_since_s = frame.time_s;
  // Once held, the hand may fidget as long as it stays near.
  state_.held = state_.near && (state_.held || frame.time_s - state_.rests_since_s >= config_.hold_s);
  return state_;
}

void HandOnHip::reset() {
  speed_.reset();
  state_ = {};
}

bool HandOnHip::is_near(const SuitFrame& frame) const {
  const Arm& arm = side_ == Side::Left ? kLeft : kRight;
  const Pose T_pelvis_odom = frame[Segment::Pelvis].inverse();
  const Pose T_pelvis_hand = T_pelvis_odom * frame[arm.hand];
  const Vector3d& wrist = T_pelvis_hand.p;
  const Vector3d palm = T_pelvis_hand * Vector3d(0, arm.outward * config_.palm_m, 0);
  const Vector3d finger = T_pelvis_hand * Vector3d(0, arm.outward * config_.finger_m, 0);
  const Vector3d hip = T_pelvis_odom * frame[arm.upper_leg].p;
  const Vector3d crest = hip + Vector3d(0, arm.outward * config_.crest_out_m, config_.crest_up_m);

  const double from_crest = side_ == Side::Left ? distance_to_segment(crest, wrist, finger) : (crest - palm).norm();
  const double below_hip = hip.z() - finger.z();
  const double inside_hip = arm.outward * hip.y() - std::max(arm.outward * wrist.y(), arm.outward * palm.y());
  return below_with_hysteresis(state_.near, elbow_angle(frame, arm), config_.elbow_on_rad, config_.elbow_off_rad) &&
         below_with_hysteresis(state_.near, from_crest, config_.hip_on_m, config_.hip_off_m) &&
         below_with_hysteresis(state_.near, below_hip, config_.below_hip_on_m, config_.below_hip_off_m) &&
         below_with_hysteresis(state_.near, inside_hip, -config_.outside_hip_on_m, -config_.outside_hip_off_m);
}

std::optional<double> HangingArm::step(const SuitFrame& frame, bool left_near) {
  constexpr double kSampleS = 0.04, kWindowS = 1.0;
  if (frame.discontinuity) reset();
  const Pose& T_odom_pelvis = frame[Segment::Pelvis];
  const Vector3d arm = frame[kRight.hand].p - frame[kRight.upper_arm].p;
  const bool hangs = angle_between(arm, -Vector3d::UnitZ()) < config_.hang_rad &&
                     elbow_angle(frame, kRight) > config_.hang_elbow_rad &&
                     frame[kRight.hand].p.z() < frame[kRight.upper_leg].p.z() + config_.hang_over_hip_m;
  if (samples_.empty() || frame.time_s - samples_.back().time_s >= kSampleS) {
    samples_.push_back({frame.time_s, T_odom_pelvis.p.head<2>(), (T_odom_pelvis.q.conjugate() * arm).x()});
    while (frame.time_s - samples_.front().time_s > kWindowS) samples_.pop_front();
  }
  if (!hangs || !swings())
    swings_since_s_.reset();
  else if (!swings_since_s_)
    swings_since_s_ = frame.time_s - 0.5 * kWindowS;  // for half of what was looked at, or more
  const bool swung = swings_since_s_ && frame.time_s - *swings_since_s_ >= 0.5 * kWindowS + config_.swing_hold_s;
  const std::optional<double> rests_since_s = rested(frame, hangs && left_near);
  return swung ? swings_since_s_ : rests_since_s;
}

std::optional<double> HangingArm::rested(const SuitFrame& frame, bool hangs) {
  const Pose& T_odom_pelvis = frame[Segment::Pelvis];
  const Vector3d wrist = T_odom_pelvis.inverse() * frame[kRight.hand].p;
  const Vector3d hip = T_odom_pelvis.inverse() * frame[kRight.upper_leg].p;
  if (!hangs || std::abs(wrist.x() - hip.x()) > config_.hang_before_hip_m) {
    rest_.reset();
    return std::nullopt;
  }
  // Once it has rested it draws nothing until it is raised, also on the way to the next thing.
  if (rest_ && rest_->long_enough) return rest_->since_s;
  const bool moved = !rest_ || (T_odom_pelvis.p - rest_->p_odom_pelvis).norm() > config_.rest_m ||
                     (wrist - rest_->p_pelvis_wrist).norm() > config_.rest_m;
  if (moved) rest_ = {frame.time_s, T_odom_pelvis.p, wrist, false};
  rest_->long_enough = frame.time_s - rest_->since_s >= config_.rest_hold_s;
  return rest_->long_enough ? std::optional(rest_->since_s) : std::nullopt;
}

bool HangingArm::swings() const {
  constexpr double kLeastS = 0.6, kJustNowS = 0.3;  // of samples to judge by; stands still as soon as that says so
  const Sample& last = samples_.back();
  const auto speed = [&](const Sample& since) {
    return (last.p_odom_pelvis - since.p_odom_pelvis).norm() / (last.time_s - since.time_s);
  };
  if (last.time_s - samples_.front().time_s < kLeastS || speed(samples_.front()) < config_.walk_speed_mps) return false;
  const auto just_now = std::find_if(samples_.begin(), samples_.end(),
                                     [&](const Sample& s) { return last.time_s - s.time_s < kJustNowS; });
  if (just_now->time_s < last.time_s && speed(*just_now) < 0.5 * config_.walk_speed_mps) return false;
  const auto [back, front] = std::minmax_element(
      samples_.begin(), samples_.end(), [](const Sample& a, const Sample& b) { return a.forward_m < b.forward_m; });
  return front->forward_m - back->forward_m > config_.swing_m;
}

void HangingArm::reset() { *this = HangingArm(config_); }

GestureFold::GestureFold(const TrackerConfig::Gesture& config)
    : left_(Side::Left, config), right_(Side::Right, second_hand(config)), hanging_(config) {}

GestureState GestureFold::step(const SuitFrame& frame) {
  const HipState left = left_.step(frame);
  const HipState right = right_.step(frame);
  const std::optional<double> hangs_since_s = hanging_.step(frame, left.near);
  const bool free = !right.held && !hangs_since_s;
  GestureState state{left.near && free, left.held && free, hangs_since_s};
  if (right.held) state.none_since_s = std::min(right.rests_since_s, hangs_since_s.value_or(HUGE_VAL));
  return state;
}

void GestureFold::reset() {
  left_.reset();
  right_.reset();
  hanging_.reset();
}

void GestureFold::resume(const std::array<HipState, 2>& hips) {
  left_.resume(hips[0]);
  right_.resume(hips[1]);
}

}  // namespace kinemap
