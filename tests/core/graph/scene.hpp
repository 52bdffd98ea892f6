// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/graph.hpp"
#include "tests/core/graph/numeric.hpp"

namespace kinemap::graph::test {

/// A small room with all kinds of landmarks and factors: `truth` has the true values, and factors that hold there to
/// `noise` standard deviations; the suit's north is at 0.4 rad and turns. Landmark 0 and 1 are walls at right angles, 2
/// a table, 3 a tilted screen, 4 a seat; touch point 0 is free, 1 fixed.
struct Scene {
  Graph truth;
  static constexpr std::size_t kWallA = 0, kWallB = 1, kTable = 2, kScreen = 3, kSeat = 4;
};

struct SceneOptions {
  std::size_t poses = 40;
  double noise = 0.0;
  bool prior = true;
  Loss loss = {};  ///< of every factor that has one
  unsigned seed = 1;
};

Scene make_scene(const SceneOptions& options);

/// The same graph with variables moved at random: poses by up to `size` m and rad, landmarks and free touching points
/// too.
Graph perturbed(const Graph& graph, double size, unsigned seed);

/// Everything turned about z by `yaw` and shifted.
Graph moved(const Graph& graph, double yaw, const Eigen::Vector3d& shift);

}  // namespace kinemap::graph::test
