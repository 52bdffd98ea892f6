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

}  // namespace

HandOnHip::HandOnHip(Side side, const TrackerConfig::Gesture& config)
    : side_(side), config_(config), velocity_(config.smoothing_s) {}

bool HandOnHip::step(const SuitFrame& frame) {
  const Segment hand = (side_ == Side::Left ? kLeft : kRight).hand;
  const double speed = velocity_.step(frame.time_s, frame[Segment::Pelvis].inverse() * frame[hand].p).norm();
  on_ = lies_on_hip(frame, speed);
  return on_;
}

void HandOnHip::reset() {
  velocity_.reset();
  on_ = false;
}

bool HandOnHip::lies_on_hip(const SuitFrame& frame, double speed_mps) const {
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

  const double below_hip = hip.z() - palm.z();
  const double inside_hip = arm.outward * hip.y() - std::max(arm.outward * wrist.y(), arm.outward * palm.y());
  return below_with_hysteresis(on_, elbow_rad, config_.elbow_on_rad, config_.elbow_off_rad) &&
         below_with_hysteresis(on_, distance_to_segment(crest, wrist, finger), config_.hip_on_m, config_.hip_off_m) &&
         below_with_hysteresis(on_, below_hip, config_.below_hip_on_m, config_.below_hip_off_m) &&
         below_with_hysteresis(on_, inside_hip, config_.inside_hip_on_m, config_.inside_hip_off_m) &&
         below_with_hysteresis(on_, speed_mps, config_.speed_on_mps, config_.speed_off_mps);
}

bool GestureFold::step(const SuitFrame& frame) {
  const bool left = left_.step(frame);
  const bool right = right_.step(frame);
  return left && !right;
}

void GestureFold::reset() {
  left_.reset();
  right_.reset();
}

}  // namespace kinemap
