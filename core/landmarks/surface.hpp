// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/landmarks/config.hpp"
#include "core/landmarks/geometry.hpp"

namespace kinemap {

/// One position of the touching point during a trace, in any level frame that does not move (the map's, with drift
/// still in it).
struct TracePoint {
  double time_s = 0.0;
  Eigen::Vector3d p;       ///< touching point, m
  Eigen::Vector3d p_body;  ///< pelvis at that time, m: tells which side of a wall the wearer is on
};

/// The part of a trace that lies on one surface.
struct Surface {
  enum class Kind : std::uint8_t { Level, Upright } kind = Kind::Upright;
  Eigen::Vector3d normal;            ///< unit; Level: up; Upright: level, towards the wearer
  double offset = 0.0;               ///< n·p = offset, m
  double spread = 0.0;               ///< robust standard deviation of the trace from it, m
  double share = 0.0;                ///< part of the trace's path that its members hold
  std::vector<std::size_t> members;  ///< indices of the points on it, ascending; one run in time, lift-offs left out
};

/// Indices [begin, end) that remain when the reach to the surface and back is cut off: at either end, a stretch of at
/// most `reach_max_s` in which the hand moves clearly faster than it usually does, up to where it comes to rest.
IndexRange without_reach(std::span<const TracePoint> points, const LandmarkConfig& config);

/// The level and the upright surface on which most of the trace lies, with their contacts; those that hold half of it,
/// the one that holds more first. The suit knows the vertical to a degree, so only these two hypotheses are
/// tried: a general plane through a nearly straight trace is not determined. How far contacts may lie from the surface
/// follows from the trace itself, since the arm of one suit errs six times as much as that of another. Points on one
/// straight level line count as upright (a wall traced at one height).
std::vector<Surface> find_surfaces(std::span<const TracePoint> points, const LandmarkConfig& config);

/// The upright one of them alone.
std::optional<Surface> find_upright_surface(std::span<const TracePoint> points, const LandmarkConfig& config);

}  // namespace kinemap
