// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/graph/marginals.hpp"
#include "core/map.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

/// In a session of hours the way of long ago is well known and moves no more. It is taken out of the graph, so that
/// memory and the time of an optimisation go with the way not yet settled, not with the length of the day:
/// - what its contacts and seats say of the objects stays as one Gaussian for each object (core/graph/fold.hpp);
/// - its odometry goes; of its poses those stay, as constants, that the way between them can be told from;
/// - its visits keep from where and, for walls, from where to where they were.
namespace kinemap {

/// From which pose of the graph on the way is not settled. It lies a quarter of an hour or more of steady work back,
/// grows in steps, cuts no visit in two, and grows only as far as the way is known well: what no closure has tied down
/// stays free however long ago it was. So a session of half an hour is never touched.
std::size_t first_unsettled_pose(const MapState& state, const graph::Marginals& marginals,
                                 const MapperConfig::Solver& config);

/// Which poses of a way have to stay for the others to be found between them, by the time, to 8 cm and 20°: the first,
/// the last, those in `wanted` (ascending indices), and as few more as that takes. Ascending indices into `way`.
std::vector<std::size_t> poses_to_keep(const std::vector<TrajectoryPose>& way, const std::vector<std::size_t>& wanted);

/// The poses `kept` (ascending) of `way`, with the noise of the steps between them.
std::vector<TrajectoryPose> thinned(const std::vector<TrajectoryPose>& way, const std::vector<std::size_t>& kept);

/// Takes the way before pose `end` out of the graph, but for the poses `kept` (ascending; with the last one before
/// `end` and every visit's key pose). `end` is of first_unsettled_pose(). False, and nothing changed, where the graph
/// cannot be evaluated.
bool fold_settled(MapState& state, std::size_t end, const std::vector<std::size_t>& kept);

}  // namespace kinemap
