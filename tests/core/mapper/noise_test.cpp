// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/noise.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/graph/optimizer.hpp"
#include "core/mapper/odometry.hpp"

namespace kinemap {
namespace {

constexpr int kPoses = 200;

/// A winding walk whose heading wanders `times` as much as the configuration expects. Every `known_every` key poses
/// the true pose is known, as it is after a closure; 0: never.
graph::Graph optimised_walk(double times, int known_every) {
  const MapperConfig::Odometry config;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  graph::Graph graph;
  Odometry odometry(config);
  Pose T_map_pelvis, T_odom_pelvis;
  KeyPose before;
  for (int i = 0; i < kPoses; ++i) {
    const double turn = 0.1 + 0.3 * normal(random);
    KeyPose key_pose;
    key_pose.id = static_cast<KeyPoseId>(i);
    key_pose.time_s = 0.3 * i;
    key_pose.path_m = 0.2;
    key_pose.turn_rad = std::abs(turn);
    if (i > 0) {
      const double error = times * heading_sigma(before, key_pose, false, config) * normal(random);
      T_map_pelvis = T_map_pelvis * level_pose({0.2, 0.0, 0.0}, turn);
      T_odom_pelvis = T_odom_pelvis * level_pose({0.2, 0.0, 0.0}, turn + error);
    }
    key_pose.T_odom_pelvis = T_odom_pelvis;
    odometry.add(key_pose, graph);
    if (known_every > 0 && i > 0 && i % known_every == 0)
      graph.priors.push_back({static_cast<std::size_t>(i), T_map_pelvis, 200.0 * graph::Matrix6::Identity()});
    before = key_pose;
  }
  EXPECT_TRUE(graph::optimize(graph, {.max_iterations = 50}).usable);
  return graph;
}

TEST(Noise, OfTheHeadingIsAsExpectedUntilLoopsTell) { EXPECT_DOUBLE_EQ(heading_noise(optimised_walk(3.0, 0)), 1.0); }

TEST(Noise, OfTheHeadingIsHeardFromLoops) {
  const double calm = heading_noise(optimised_walk(0.1, 10)), usual = heading_noise(optimised_walk(1.0, 10)),
               wild = heading_noise(optimised_walk(3.0, 10));
  EXPECT_LT(calm, 0.6);
  EXPECT_NEAR(usual, 1.0, 0.3);
  EXPECT_GT(wild, 1.7);
}

}  // namespace
}  // namespace kinemap
