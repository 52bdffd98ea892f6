// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace kinemap {

/// Signed area of a closed polygon (the last corner meets the first), > 0 counter-clockwise.
double area(std::span<const Eigen::Vector2d> polygon);

/// Is `p` inside (even-odd rule)?
bool contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p);

/// Do no two of its sides cross?
bool is_simple(std::span<const Eigen::Vector2d> polygon);

/// Do the ways from p to q and from r to s cross? Touching is not crossing.
bool ways_cross(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r, const Eigen::Vector2d& s);

}  // namespace kinemap
