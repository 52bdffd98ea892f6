// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/graph/graph.hpp"
#include "core/landmarks/config.hpp"

namespace kinemap {

/// Which side of the rectangle a contact was drawn along, and the second one where it ends an open contour in a corner.
struct SideLabel {
  graph::Edge edge = graph::Edge::None;
  graph::Edge corner = graph::Edge::None;
};

/// A rectangle fitted to a contour in its plane. Local axes: u at `heading` from the first axis of the plane, v 90° to
/// its left.
struct RectangleFit {
  Eigen::Vector2d centre;         ///< m
  double heading = 0.0;           ///< rad, in (−45°, 45°] of the first axis for a free rectangle
  std::array<double, 2> size{};   ///< along u, along v, m
  std::vector<SideLabel> labels;  ///< one for each point
  std::array<bool, 4> drawn{};    ///< MinusU, PlusU, MinusV, PlusV: was the side followed?
  bool closed = false;            ///< all four sides were drawn
  double rms = 0.0;               ///< of the labelled points' distances from their sides, m
};

/// Signed coordinates of `p` in the rectangle's axes, m.
Eigen::Vector2d to_local(const RectangleFit& fit, const Eigen::Vector2d& p);

/// Fits a rectangle to an ordered contour of two adjacent sides (L), three (U) or all four: the closed form of the
/// paper (corners by line angles, fourth corner by mirroring) gives the start, then sides are assigned by the direction
/// of travel and the five numbers are fitted by iteratively reweighted least squares (Cauchy). `fixed_heading` where
/// the orientation in the plane is known (screens). nullopt when fewer than two adjacent sides were drawn or a side is
/// out of the configured range.
std::optional<RectangleFit> fit_rectangle(std::span<const Eigen::Vector2d> points, const LandmarkConfig& config,
                                          std::optional<double> fixed_heading = std::nullopt);

}  // namespace kinemap
