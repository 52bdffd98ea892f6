// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/key_poses.hpp"

#include <cmath>

namespace kinemap {
namespace {

// The heading of a pelvis whose forward axis is nearly upright (lying) means nothing: the last one holds.
double heading_or(const Pose& T_odom_pelvis, double otherwise) {
  const Eigen::Vector3d forward = T_odom_pelvis.q * Eigen::Vector3d::UnitX();
  return std::abs(forward.z()) < 0.95 ? heading_of(T_odom_pelvis.q) : otherwise;
}

}  // namespace

void KeyPoseFold::resume(const Interrupted& before, double unseen_path_m) {
  started_ = true;
  latest_ = before.key_poses.back();
  next_.id = latest_.id + 1;
  restart(latest_.T_odom_pelvis);
  latest_heading_ = heading_;
  if (before.since_key_pose) {
    restart(before.since_key_pose->T_odom_pelvis);
    next_.path_m = before.since_key_pose->path_m;
    next_.turn_rad = before.since_key_pose->turn_rad;
  }
  next_.path_m += unseen_path_m;
}

SinceKeyPose KeyPoseFold::since_latest() const {
  KeyPoseFold whole = *this;
  whole.advance(next_.T_odom_pelvis, 0.0, 0.0);
  return {next_.T_odom_pelvis, whole.next_.path_m, whole.next_.turn_rad};
}

std::optional<KeyPose> KeyPoseFold::step(const SuitFrame& frame, Demand demand,
                                         const std::optional<Eigen::Vector3d>& p_pelvis_stance,
                                         std::optional<bool> field_disturbed, const std::optional<Slip>& slip) {
  const Pose& T_odom_pelvis = frame[Segment::Pelvis];
  const bool broken = started_ && frame.discontinuity;
  if (!started_ || broken) restart(T_odom_pelvis);
  advance(T_odom_pelvis, config_.path_step_m, config_.turn_step_rad);
  next_.time_s = frame.time_s;
  next_.T_odom_pelvis = T_odom_pelvis;
  next_.discontinuity = broken;
  next_.p_pelvis_stance = p_pelvis_stance;
  next_.slip = slip;
  if (field_disturbed) next_.field_disturbed = *field_disturbed || next_.field_disturbed.value_or(false);
  if (started_ && !broken && !due(frame, demand)) return std::nullopt;
  started_ = true;
  return emit();
}

std::optional<KeyPose> KeyPoseFold::finish() {
  if (!started_ || next_.time_s <= latest_.time_s) return std::nullopt;
  return emit();
}

bool KeyPoseFold::due(const SuitFrame& frame, Demand demand) const {
  const double distance = (frame[Segment::Pelvis].p - latest_.T_odom_pelvis.p).head<2>().norm();
  const double turn = std::abs(wrap_angle(heading_ - latest_heading_));
  const double age = frame.time_s - latest_.time_s;
  return demand.now || distance >= config_.distance_m || turn >= config_.turn_rad ||
         age >= (demand.busy ? config_.tracing_s : config_.idle_s);
}

void KeyPoseFold::advance(const Pose& T_odom_pelvis, double path_step_m, double turn_step_rad) {
  const double path = (T_odom_pelvis.p - path_point_).head<2>().norm();
  if (path >= path_step_m) {
    next_.path_m += path;
    total_path_m_ += path;
    path_point_ = T_odom_pelvis.p;
  }
  heading_ = heading_or(T_odom_pelvis, heading_);
  const double turn = std::abs(wrap_angle(heading_ - turn_heading_));
  if (turn >= turn_step_rad) {
    next_.turn_rad += turn;
    turn_heading_ = heading_;
  }
}

void KeyPoseFold::restart(const Pose& T_odom_pelvis) {
  next_.path_m = 0.0;
  next_.turn_rad = 0.0;
  path_point_ = T_odom_pelvis.p;
  heading_ = heading_or(T_odom_pelvis, 0.0);
  turn_heading_ = heading_;
}

KeyPose KeyPoseFold::emit() {
  advance(next_.T_odom_pelvis, 0.0,
          0.0);  // the rest below one step, so that the path is never shorter than the distance
  latest_ = next_;
  latest_heading_ = heading_;
  ++next_.id;
  next_.path_m = 0.0;
  next_.turn_rad = 0.0;
  next_.field_disturbed.reset();
  return latest_;
}

}  // namespace kinemap
