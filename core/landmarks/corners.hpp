// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/landmarks/config.hpp"
#include "core/landmarks/geometry.hpp"

namespace kinemap {

/// Corners of a contour in its plane (paper, section IV): for each point, lines are fitted to its neighbours within
/// `window_m` of path on both sides; corners are the local maxima of the angle θ between them that exceed
/// `min_angle_rad`. `points` in order, roughly evenly spaced; m. Ascending indices; the ends (less than half a window
/// from either) are never corners.
std::vector<std::size_t> find_corners(std::span<const Eigen::Vector2d> points, double window_m, double min_angle_rad);

/// θ for each point, rad in [0, π]; 0 where a side has too few points.
std::vector<double> corner_angles(std::span<const Eigen::Vector2d> points, double window_m);

/// `points` without the hand's way to an edge and from it: what a corner sets apart, no farther than 0.3 m from either
/// end. It looks like two short sides of a rectangle that is open towards the wearer.
IndexRange without_way(std::span<const Eigen::Vector2d> points, const LandmarkConfig& config);

/// The fourth corner of a table of which two adjacent sides were drawn: the corner between them, mirrored over the
/// diagonal of the two points that are farthest apart (paper, section IV), i.e. through its middle.
Eigen::Vector2d fourth_corner(const Eigen::Vector2d& corner, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// Indices of the two points that are farthest apart (0, 0 for fewer than two).
std::pair<std::size_t, std::size_t> farthest_pair(std::span<const Eigen::Vector2d> points);

}  // namespace kinemap
