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

double distance_to_segment(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const double along = (point - a).dot(b - a) / (b - a).squaredNorm();
  return (point - a - std::clamp(along, 0.0, 1.0) * (b - a)).norm();
}

// The right hand draws beside its hip now and then, so it must prove harder that it lies there.
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
  const Vector3d& elbow = frame[arm.forearm].p;
  const double elbow_rad = angle_between(frame[arm.upper_arm].p - elbow, frame[arm.hand].p - elbow);

  const Pose T_pelvis_odom = frame[Segment::Pelvis].inverse();
  const Pose T_pelvis_hand = T_pelvis_odom * frame[arm.hand];
  const Vector3d& wrist = T_pelvis_hand.p;
  const Vector3d palm = T_pelvis_hand * Vector3d(0, arm.outward * config_.palm_m, 0);
  const Vector3d finger = T_pelvis_hand * Vector3d(0, arm.outward * config_.finger_m, 0);
  const Vector3d hip = T_pelvis_odom * frame[arm.upper_leg].p;
  const Vector3d crest = hip + Vector3d(0, arm.outward * config_.crest_out_m, config_.crest_up_m);

  const double below_hip = hip.z() - finger.z();
  const double inside_hip = arm.outward * hip.y() - std::max(arm.outward * wrist.y(), arm.outward * palm.y());
  return below_with_hysteresis(state_.near, elbow_rad, config_.elbow_on_rad, config_.elbow_off_rad) &&
         below_with_hysteresis(state_.near, distance_to_segment(crest, wrist, finger), config_.hip_on_m,
                               config_.hip_off_m) &&
         below_with_hysteresis(state_.near, below_hip, config_.below_hip_on_m, config_.below_hip_off_m) &&
         below_with_hysteresis(state_.near, inside_hip, -config_.outside_hip_on_m, -config_.outside_hip_off_m);
}

GestureFold::GestureFold(const TrackerConfig::Gesture& config)
    : left_(Side::Left, config), right_(Side::Right, second_hand(config)) {}

GestureState GestureFold::step(const SuitFrame& frame) {
  const HipState left = left_.step(frame);
  const HipState right = right_.step(frame);
  GestureState state{left.near && !right.held, left.held && !right.held, std::nullopt};
  if (right.held) state.both_since_s = right.rests_since_s;
  return state;
}

void GestureFold::reset() {
  left_.reset();
  right_.reset();
}

void GestureFold::resume(const std::array<HipState, 2>& hips) {
  left_.resume(hips[0]);
  right_.resume(hips[1]);
}

}  // namespace kinemap
