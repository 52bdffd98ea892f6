// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

/// The simulator's own small mathematics: it must not share code with the estimator that is judged by it.
namespace kinemap::sim {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

inline constexpr double kPi = std::numbers::pi;
inline double radians(double degrees) { return degrees * kPi / 180.0; }
inline double wrapped(double angle) { return std::remainder(angle, 2.0 * kPi); }
inline Vec2 direction(double heading) { return {std::cos(heading), std::sin(heading)}; }
inline double heading_of(const Vec2& v) { return std::atan2(v.y(), v.x()); }
inline Vec2 left_of(const Vec2& v) { return {-v.y(), v.x()}; }
inline Vec3 lift(const Vec2& v, double z) { return {v.x(), v.y(), z}; }
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

inline Quat about_x(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())); }
inline Quat about_y(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())); }
inline Quat about_z(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ())); }
inline Quat rotation(const Vec3& vector) {
  const double angle = vector.norm();
  return angle < 1e-12 ? Quat::Identity() : Quat(Eigen::AngleAxisd(angle, vector / angle));
}

/// Position and orientation of a segment frame in the world.
struct Placed {
  Vec3 p = Vec3::Zero();
  Quat q = Quat::Identity();
};

/// 0 at u ≤ 0, 1 at u ≥ 1, with no velocity and no acceleration at both ends.
inline double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

/// Distance of `p` from the piece a–b.
inline double distance_to_piece(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double length2 = d.squaredNorm();
  const double u = length2 > 0.0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (p - a - u * d).norm();
}

/// Gaussian smoothing along the samples (ends held), by three box filters: linear in the number of samples.
template <class T>
void smooth_samples(std::vector<T>& samples, double sigma_samples) {
  const auto n = static_cast<long>(samples.size());
  const long half = std::lround((std::sqrt(4.0 * sigma_samples * sigma_samples + 1.0) - 1.0) / 2.0);
  if (half < 1 || n < 2) return;
  std::vector<T> out(samples.size());
  for (int pass = 0; pass < 3; ++pass) {
    const auto at = [&](long i) -> const T& { return samples[static_cast<std::size_t>(std::clamp(i, 0L, n - 1))]; };
    T sum = at(0) * 0.0;
    for (long i = -half; i <= half; ++i) sum += at(i);
    for (long i = 0; i < n; ++i) {
      out[static_cast<std::size_t>(i)] = sum / static_cast<double>(2 * half + 1);
      sum += at(i + half + 1) - at(i - half);
    }
    samples.swap(out);
  }
}

}  // namespace kinemap::sim
