// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/corners.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinemap {
namespace {

/// Direction of travel over points [a, b]: a line fit, pointed along the path. Zero when undetermined.
Eigen::Vector2d travel(std::span<const Eigen::Vector2d> points, std::size_t a, std::size_t b) {
  if (b < a + 2) return Eigen::Vector2d::Zero();
  const auto line = fit_line(points.subspan(a, b - a + 1));
  if (!line) return Eigen::Vector2d::Zero();
  return line->direction.dot(points[b] - points[a]) < 0.0 ? Eigen::Vector2d(-line->direction) : line->direction;
}

}  // namespace

std::vector<double> corner_angles(std::span<const Eigen::Vector2d> points, double window_m) {
  const std::size_t n = points.size();
  std::vector<double> path(n, 0.0), theta(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) path[i] = path[i - 1] + (points[i] - points[i - 1]).norm();
  std::size_t a = 0, b = 0;
  for (std::size_t i = 0; i < n; ++i) {
    while (path[i] - path[a] > window_m) ++a;
    while (b + 1 < n && path[b + 1] - path[i] <= window_m) ++b;
    if (path[i] - path[a] < 0.5 * window_m || path[b] - path[i] < 0.5 * window_m) continue;
    const Eigen::Vector2d before = travel(points, a, i), after = travel(points, i, b);
    if (before.isZero() || after.isZero()) continue;
    theta[i] = std::acos(std::clamp(before.dot(after), -1.0, 1.0));
  }
  return theta;
}

std::vector<std::size_t> find_corners(std::span<const Eigen::Vector2d> points, double window_m, double min_angle_rad) {
  const auto theta = corner_angles(points, window_m);
  std::vector<double> path(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) path[i] = path[i - 1] + (points[i] - points[i - 1]).norm();
  std::vector<std::size_t> corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (theta[i] < min_angle_rad) continue;
    bool maximum = true;
    for (std::size_t j = 0; j < points.size() && maximum; ++j) {
      const double apart = std::abs(path[j] - path[i]);
      if (j != i && apart <= window_m) maximum = theta[j] < theta[i] || (theta[j] == theta[i] && j > i);
    }
    if (maximum) corners.push_back(i);
  }
  return corners;
}

IndexRange without_way(std::span<const Eigen::Vector2d> points, const LandmarkConfig& config) {
  constexpr double kReach = 0.3;  // m
  IndexRange kept{0, points.size()};
  for (const std::size_t corner : find_corners(points, config.corner_window_m, config.corner_angle_rad)) {
    const bool early = corner < points.size() / 2;
    if ((points[corner] - (early ? points.front() : points.back())).norm() > kReach) continue;
    if (early)
      kept.begin = corner;
    else
      kept.end = std::min(kept.end, corner + 1);
  }
  return kept;
}

Eigen::Vector2d fourth_corner(const Eigen::Vector2d& corner, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a + b - corner;
}

std::pair<std::size_t, std::size_t> farthest_pair(std::span<const Eigen::Vector2d> points) {
  std::pair<std::size_t, std::size_t> best{0, 0};
  double longest = -1.0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if (const double d = (points[i] - points[j]).squaredNorm(); d > longest) longest = d, best = {i, j};
  return best;
}

}  // namespace kinemap
