// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/graph/graph.hpp"
#include "core/landmarks/config.hpp"
#include "core/landmarks/rectangle.hpp"
#include "core/landmarks/surface.hpp"

namespace kinemap {

/// A landmark seen in one trace: its closed-form values, and which contacts speak of it.
struct Observation {
  graph::Landmark landmark;           ///< Wall, Table or Screen
  std::vector<std::size_t> contacts;  ///< indices of the trace points on it, ascending
  std::vector<SideLabel> labels;      ///< one for each of them; Edge::None throughout for walls
  bool closed = false;                ///< rectangles: all four sides were drawn
};

/// What a trace turned out to be. Where nothing was found in it, `reason` says why, since nothing is dropped in
/// silence, and `tried` which contacts lie on the surface that holds most of it (may be empty).
struct Extraction {
  std::vector<Observation> observations;
  std::string reason;
  IndexRange tried;
};

/// Finds the objects that a trace was drawn on (paper, section IV). `points` in order of time, in a frame with z up and
/// the floor at `floor_z`.
Extraction extract_landmarks(std::span<const TracePoint> points, double floor_z, const LandmarkConfig& config);

}  // namespace kinemap
