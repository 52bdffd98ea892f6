// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

/// Rotations and their tangent, rad; stable at 0 and up to π. Formulas: Solà, Deray, Atchuthan, "A micro Lie theory",
/// eq. 132–143.
namespace kinemap::graph {

/// [v]× with [v]×·a = v × a.
inline Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Unit quaternion of the rotation by |theta| about theta.
inline Eigen::Quaterniond so3_exp(const Eigen::Vector3d& theta) {
  const double angle2 = theta.squaredNorm();
  if (angle2 < 1e-8) {  // series of cos(a/2), sin(a/2)/a: the next terms are below 1e-17
    const double s = 0.5 - angle2 / 48.0;
    return {1.0 - angle2 / 8.0, s * theta.x(), s * theta.y(), s * theta.z()};
  }
  const double angle = std::sqrt(angle2);
  const double s = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * theta.x(), s * theta.y(), s * theta.z()};
}

/// Rotation vector of a unit quaternion, |result| ≤ π; q and −q give the same.
inline Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * q.w();
  const Eigen::Vector3d v = sign * q.vec();
  const double n2 = v.squaredNorm();
  if (n2 < 1e-8) return (2.0 / w) * (1.0 - n2 / (3.0 * w * w)) * v;  // atan(n/w)/n in series
  const double n = std::sqrt(n2);
  return (2.0 * std::atan2(n, w) / n) * v;
}

/// Inverse of the right Jacobian: log(exp(theta)·exp(δ)) = theta + Jr⁻¹(theta)·δ + O(δ²). Finite for |theta| < 2π.
inline Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& theta) {
  const double a2 = theta.squaredNorm();
  double c = 0.0;   // (1 − (a/2)·cot(a/2)) / a²
  if (a2 < 1e-2) {  // the closed form cancels here; the series is exact to 1e-15
    c = 1.0 / 12.0 + a2 / 720.0 + a2 * a2 / 30240.0 + a2 * a2 * a2 / 1209600.0;
  } else {
    const double half = 0.5 * std::sqrt(a2);
    c = (1.0 - half * std::cos(half) / std::sin(half)) / a2;
  }
  const Eigen::Matrix3d k = hat(theta);
  return Eigen::Matrix3d::Identity() + 0.5 * k + c * (k * k);
}

}  // namespace kinemap::graph
