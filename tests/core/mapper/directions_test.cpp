// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/directions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/graph/optimizer.hpp"

namespace kinemap {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

/// Walls whose headings are known to `sigma`, each by itself.
MapState walls_with(const std::vector<double>& headings, double sigma) {
  MapState state;
  state.graph.poses.push_back({});
  state.graph.priors.push_back({0, {}, graph::Matrix6::Identity()});
  for (const double heading : headings) {
    const std::size_t k = state.graph.landmarks.size();
    graph::Landmark wall;
    wall.x[0] = heading;
    state.graph.landmarks.push_back(wall);
    state.landmarks.push_back({});
    state.graph.landmark_priors.push_back({k, 0, heading, sigma});
    state.graph.landmark_priors.push_back({k, 1, 0.0, 0.05});
  }
  return state;
}

/// As the mapper does it: decide, optimise, decide again until nothing changes.
void align(MapState& state, const MapperConfig::Walls& config = {}) {
  for (int round = 0; round < 6; ++round) {
    const auto marginals = graph::Marginals::compute(state.graph);
    ASSERT_TRUE(marginals);
    const bool first = !state.direction;
    const bool changed = align_walls(state, *marginals, config);
    ASSERT_TRUE(graph::optimize(state.graph, {}).usable);
    if (!changed && !first) return;
  }
}

bool aligned(const MapState& state, std::size_t wall) {
  for (const auto& factor : state.graph.parallels)
    if (factor.b == wall) return true;
  return false;
}

TEST(AlignWalls, DriftedWallsComeToRightAngles) {
  const double drift = 0.12;  // rad, of walls known to 0.1
  MapState state = walls_with({0.0, kQuarter + drift, 2.0 * kQuarter, -kQuarter - drift}, 0.1);
  align(state);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(aligned(state, k));
    EXPECT_NEAR(std::remainder(state.graph.landmarks[k].x[0] - state.graph.landmarks[*state.direction].x[0], kQuarter),
                0.0, 0.02);
  }
}

TEST(AlignWalls, AnObliqueWallStays) {
  MapState state = walls_with({0.0, kQuarter, 0.3, 2.0 * kQuarter}, 0.03);
  align(state);
  EXPECT_FALSE(aligned(state, 2));
  EXPECT_NEAR(state.graph.landmarks[2].x[0], 0.3, 1e-6);
  for (const std::size_t k : {0, 1, 3}) EXPECT_TRUE(aligned(state, k));
}

TEST(AlignWalls, AnObliqueWallThatWasSeenFirstDoesNotGiveTheDirection) {
  MapState state = walls_with({0.4, 0.0, kQuarter, 2.0 * kQuarter}, 0.03);
  align(state);
  EXPECT_FALSE(aligned(state, 0));
  for (const std::size_t k : {1, 2, 3}) EXPECT_TRUE(aligned(state, k));
}

TEST(AlignWalls, AWallThatCouldMeanEitherRightAngleIsLeftFree) {
  MapState state = walls_with({0.0, kQuarter, kQuarter / 2.0}, 0.03);
  state.graph.landmark_priors[4].sigma = 0.6;  // the third one's heading
  align(state);
  EXPECT_FALSE(aligned(state, 2));
}

TEST(AlignWalls, ADecisionIsTakenBackWhenTheWallIsKnownBetter) {
  MapState state = walls_with({0.0, kQuarter, 0.25}, 0.02);
  state.graph.landmark_priors[4].sigma = 0.15;  // the third one's heading
  align(state);
  ASSERT_TRUE(aligned(state, 2));
  state.graph.landmark_priors[4].sigma = 0.01;           // seen again, and it is oblique
  ASSERT_TRUE(graph::optimize(state.graph, {}).usable);  // decisions are taken at an optimum
  align(state);
  EXPECT_FALSE(aligned(state, 2));
  EXPECT_NEAR(state.graph.landmarks[2].x[0], 0.25, 0.01);
}

TEST(AlignWalls, NoneWhenSwitchedOff) {
  MapState state = walls_with({0.0, kQuarter}, 0.1);
  MapperConfig::Walls config;
  config.right_angle_sigma_rad = 0.0;
  const auto marginals = graph::Marginals::compute(state.graph);
  ASSERT_TRUE(marginals);
  EXPECT_FALSE(align_walls(state, *marginals, config));
  EXPECT_TRUE(state.graph.parallels.empty());
}

}  // namespace
}  // namespace kinemap
