// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

/// Twice the signed area of the triangle a, b, c.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace

double area(std::span<const Eigen::Vector2d> polygon) {
  double twice = 0.0;
  for (std::size_t k = 0; k < polygon.size(); ++k)
    twice += turn(Eigen::Vector2d::Zero(), polygon[k], polygon[(k + 1) % polygon.size()]);
  return 0.5 * twice;
}

bool contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

bool ways_cross(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r,
                const Eigen::Vector2d& s) {
  return turn(p, q, r) * turn(p, q, s) < 0.0 && turn(r, s, p) * turn(r, s, q) < 0.0;
}

bool is_simple(std::span<const Eigen::Vector2d> polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j)
      if (ways_cross(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % n])) return false;
  return true;
}

}  // namespace kinemap
