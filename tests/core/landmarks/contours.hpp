// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <random>
#include <span>
#include <vector>

#include "core/landmarks/surface.hpp"

/// Hand-made contours for the tests of the landmark extraction: straight legs at constant speed with Gaussian noise.
namespace kinemap::test {

/// Points every `spacing` metres along the polyline.
inline std::vector<Eigen::Vector3d> along(const std::vector<Eigen::Vector3d>& polyline, double spacing) {
  std::vector<Eigen::Vector3d> out;
  for (std::size_t k = 1; k < polyline.size(); ++k) {
    const Eigen::Vector3d leg = polyline[k] - polyline[k - 1];
    const auto n = static_cast<int>(leg.norm() / spacing);
    for (int i = 0; i < n; ++i) out.push_back(polyline[k - 1] + leg * (static_cast<double>(i) / n));
  }
  if (!polyline.empty()) out.push_back(polyline.back());
  return out;
}

struct Contour {
  double speed_m_per_s = 0.3;
  double noise_m = 0.004;
  std::uint32_t seed = 1;
  Eigen::Vector3d body{0.0, 0.0, 1.0};  ///< where the wearer stands
};

/// A trace along the polyline as the tracker would give it: a point each 2 cm.
inline std::vector<TracePoint> trace(const std::vector<Eigen::Vector3d>& polyline, const Contour& contour = {}) {
  std::mt19937 random(contour.seed);
  std::normal_distribution<double> noise(0.0, contour.noise_m);
  std::vector<TracePoint> out;
  double t = 0.0;
  const auto path = along(polyline, 0.02);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) t += (path[i] - path[i - 1]).norm() / contour.speed_m_per_s;
    out.push_back({t, path[i] + Eigen::Vector3d(noise(random), noise(random), noise(random)), contour.body});
  }
  return out;
}

/// Appends a reach: a fast straight way from `from` to the first point (in front) or from the last point to `from`
/// (behind).
inline std::vector<TracePoint> with_reach(std::vector<TracePoint> points, const Eigen::Vector3d& from, double seconds) {
  const auto n = static_cast<int>(seconds / 0.02);
  std::vector<TracePoint> in, out;
  const auto smooth = [](double x) { return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x); };  // minimum jerk
  for (int i = 0; i < n; ++i) {
    const double x = smooth(static_cast<double>(i) / n);
    in.push_back({0.02 * i, from + x * (points.front().p - from), points.front().p_body});
  }
  for (const auto& p : points) in.push_back({p.time_s + seconds + 0.1, p.p, p.p_body});
  const double t0 = in.back().time_s + 0.1;
  const Eigen::Vector3d last = in.back().p, body = in.back().p_body;
  for (int i = 1; i <= n; ++i) {
    const double x = smooth(static_cast<double>(i) / n);
    in.push_back({t0 + 0.02 * i, last + x * (from - last), body});
  }
  return in;
}

/// Corners of a level rectangle, counter-clockwise from (−u, −v).
inline std::vector<Eigen::Vector3d> level_rectangle(const Eigen::Vector3d& centre, double heading, double length,
                                                    double width) {
  const Eigen::AngleAxisd turn(heading, Eigen::Vector3d::UnitZ());
  std::vector<Eigen::Vector3d> out;
  for (const auto& [u, v] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
    out.push_back(centre + turn * Eigen::Vector3d(u * length / 2.0, v * width / 2.0, 0.0));
  return out;
}

/// Corners of an upright rectangle whose normal has the given heading.
inline std::vector<Eigen::Vector3d> upright_rectangle(const Eigen::Vector3d& centre, double heading, double width,
                                                      double height) {
  const Eigen::Vector3d u(-std::sin(heading), std::cos(heading), 0.0);
  std::vector<Eigen::Vector3d> out;
  for (const auto& [a, b] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
    out.push_back(centre + a * width / 2.0 * u + b * height / 2.0 * Eigen::Vector3d::UnitZ());
  return out;
}

}  // namespace kinemap::test
