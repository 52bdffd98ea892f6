// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kinemap {

/// Triangles (indices of corners, counter-clockwise) that fill a simple counter-clockwise polygon, by cutting ears:
/// O(n³), for room outlines. Empty for fewer than 3 corners; a polygon that crosses itself yields the ears that could
/// be cut.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Eigen::Vector2d> polygon);

}  // namespace kinemap
