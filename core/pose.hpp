// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace kinemap {

/// Rigid transform `T_a_b`: takes point coordinates in frame b to frame a. Metres; `q` is a unit quaternion.
/// Names cancel like fractions: `T_map_hand = T_map_pelvis * T_pelvis_hand`.
struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  Pose operator*(const Pose& b) const { return {p + q * b.p, (q * b.q).normalized()}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return p + q * point; }
  [[nodiscard]] Pose inverse() const {
    const Eigen::Quaterniond qi = q.conjugate();
    return {-(qi * p), qi};
  }
};

/// `angle` wrapped to (−π, π].
inline double wrap_angle(double angle) {
  angle = std::remainder(angle, 2.0 * std::numbers::pi);
  return angle <= -std::numbers::pi ? angle + 2.0 * std::numbers::pi : angle;
}

/// Heading (rotation about the upward z axis, rad) of the frame's +x axis; for a level +x it equals the yaw angle.
inline double heading_of(const Eigen::Quaterniond& q) {
  const Eigen::Vector3d x = q * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

/// Level pose at `p` whose +x axis has the given heading (rad).
inline Pose level_pose(const Eigen::Vector3d& p, double heading) {
  return {p, Eigen::Quaterniond(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()))};
}

}  // namespace kinemap
