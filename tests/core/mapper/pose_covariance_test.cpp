// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/pose_covariance.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/mapper/odometry.hpp"

namespace kinemap {
namespace {

/// A winding walk with the noise that the mapper gives it.
graph::Graph walk(std::size_t poses, const MapperConfig::Odometry& config) {
  std::mt19937 random(3);
  graph::Graph graph;
  Pose T_odom_before;
  Odometry odometry(config);
  for (std::size_t i = 0; i < poses; ++i) {
    KeyPose next;
    next.id = static_cast<KeyPoseId>(i);
    const double turn = std::normal_distribution(0.1, 0.3)(random);
    if (i > 0) next.T_odom_pelvis = T_odom_before * level_pose({0.2, 0.0, 0.0}, turn);
    next.time_s = 0.3 * static_cast<double>(i);
    next.path_m = 0.2;
    next.turn_rad = std::abs(turn);
    odometry.add(next, graph);
    T_odom_before = next.T_odom_pelvis;
  }
  return graph;
}

TEST(PoseCovariance, CarriedOnByOdometryItIsTheGraphsMarginal) {
  MapperConfig::Odometry config;
  config.heading_return_s = 1e6;  // what is carried on does not know that the heading comes back …
  config.north_rate_rad_per_s = config.north_rad_per_sqrt_s = 1e-5;  // … nor that the north drifts
  const graph::Graph graph = walk(60, config);
  const auto marginals = graph::Marginals::compute(graph);
  ASSERT_TRUE(marginals);
  PoseCovariance expected(config), carried(config);
  expected.set(graph.poses.back(), newest_marginal(graph, *marginals));
  for (const auto& between : graph.between)
    carried.add(graph.poses[between.i], between.T_i_j, step_sigma(graph, between));

  const graph::Matrix6 a = expected.published(graph.poses.back(), graph.poses.back().p, 1.0);
  const graph::Matrix6 b = carried.published(graph.poses.back(), graph.poses.back().p, 1.0);
  for (const int i : {0, 1, 5})
    for (const int j : {0, 1, 5}) EXPECT_NEAR(b(i, j), a(i, j), 0.05 * std::sqrt(a(i, i) * a(j, j))) << i << ' ' << j;
}

TEST(PoseCovariance, IsGivenInTheMapsAxesWithTheScaleOfTheWay) {
  MapperConfig::Odometry config;
  PoseCovariance covariance(config);
  graph::Matrix6 marginal = graph::Matrix6::Zero();
  marginal(0, 0) = 0.04;  // forward
  marginal(5, 5) = 0.01;
  const Pose facing_y = level_pose({0.0, 10.0, 1.0}, 0.5 * std::numbers::pi);
  covariance.set(facing_y, marginal);
  const graph::Matrix6 out = covariance.published(facing_y, Eigen::Vector3d::Zero(), 1.0);
  EXPECT_NEAR(out(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(out(1, 1), 0.04 + std::pow(10.0 * config.scale_sigma, 2), 1e-12);
  EXPECT_NEAR(out(5, 5), 0.01, 1e-12);
  const graph::Matrix6 better = covariance.published(facing_y, Eigen::Vector3d::Zero(), 0.5);
  EXPECT_NEAR(better(1, 1), 0.04 + std::pow(10.0 * 0.5 * config.scale_sigma, 2), 1e-12);
}

}  // namespace
}  // namespace kinemap
