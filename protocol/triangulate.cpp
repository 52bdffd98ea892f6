// SPDX-License-Identifier: Apache-2.0
#include "protocol/triangulate.hpp"

#include <algorithm>

namespace kinemap {
namespace {

using Corner = Eigen::Vector2d;

/// Twice the signed area: > 0 when a → b → c turns left.
double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool inside(const Corner& p, const Corner& a, const Corner& b, const Corner& c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

/// True when the corner `at` of what is left sticks out and no other corner lies in its triangle.
bool is_ear(std::span<const Corner> polygon, const std::vector<std::uint32_t>& left, std::size_t at) {
  const std::size_t n = left.size();
  const Corner& a = polygon[left[(at + n - 1) % n]];
  const Corner& b = polygon[left[at]];
  const Corner& c = polygon[left[(at + 1) % n]];
  if (turn(a, b, c) <= 0.0) return false;
  return std::none_of(left.begin(), left.end(), [&](std::uint32_t i) {
    const Corner& p = polygon[i];
    return p != a && p != b && p != c && inside(p, a, b, c);
  });
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Corner> polygon) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> left(polygon.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() >= 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(polygon, left, ear)) ++ear;
    if (ear == left.size()) break;  // only corners on one line are left, or the outline crosses itself
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace kinemap
