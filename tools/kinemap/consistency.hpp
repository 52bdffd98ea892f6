// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/map.hpp"
#include "tools/kinemap/shape.hpp"

/// Do the sigmas that a map reports agree with its errors?
namespace kinemap::eval {

/// Estimate less truth, over the sigma that the map reports for it; nothing where it reports none. Sigmas are relative
/// to the first pose of the trajectory (the gauge of the graph), so positions and headings are judged after laying the
/// map onto the truth there. An alignment of the whole trajectory spreads the drift since then over the map and takes
/// part of it away: those errors are smaller, and given beside.
struct NormalisedErrors {
  std::vector<double> size;      ///< of each edge; walls: the length
  std::vector<double> position;  ///< x and y of the centre; walls: across the wall
  std::vector<double> heading;
  std::vector<double> aligned_position;
  std::vector<double> aligned_heading;

  void add(const NormalisedErrors& other);
};

/// The two ways in which a map is laid onto the truth.
struct Gauges {
  Pose from_start;
  Pose aligned;
};

NormalisedErrors normalised_errors(const Shape& truth, const MapObject& object, const Gauges& T_truth_map);

/// How a sample of normalised errors compares with the standard normal distribution.
struct Consistency {
  std::size_t n = 0;
  double within_1 = 0.0;  ///< share with |e| ≤ 1; of a normal distribution 68.3 %
  double within_2 = 0.0;  ///< 95.4 %
  double mean = 0.0;      ///< 0
  double rms = 0.0;       ///< 1
};
Consistency consistency_of(const std::vector<double>& normalised);

}  // namespace kinemap::eval
