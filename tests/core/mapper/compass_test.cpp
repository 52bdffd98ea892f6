// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/compass.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/graph/marginals.hpp"
#include "core/graph/optimizer.hpp"
#include "core/mapper/odometry.hpp"

namespace kinemap {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A wearer who stands and turns on the spot, a key pose each second. The suit's heading is off by `error` (rad, s).
template <class Error>
graph::Graph stand(int seconds, Odometry& odometry, Error&& error) {
  graph::Graph graph;
  for (int i = 0; i < seconds; ++i) {
    KeyPose k;
    k.id = static_cast<KeyPoseId>(i);
    k.time_s = i;
    k.T_odom_pelvis = level_pose({0, 0, 1}, 0.1 * i + error(static_cast<double>(i)));
    odometry.add(k, graph);
  }
  return graph;
}

double heading_error(const graph::Graph& graph, std::size_t i) {
  return wrap_angle(heading_of(graph.poses[i].q) - 0.1 * static_cast<double>(i));
}

/// Holds the heading of pose `i` to the true one.
void tell_heading(graph::Graph& graph, std::size_t i) {
  graph::PriorFactor prior;
  prior.i = i;
  prior.T_map_i = {graph.poses[i].p, level_pose(Eigen::Vector3d::Zero(), 0.1 * static_cast<double>(i)).q};
  prior.sqrt_information = graph::Matrix6::Zero();
  prior.sqrt_information(5, 5) = 1.0 / (0.5 * kDegree);
  graph.priors.push_back(prior);
}

double heading_sigma_of(const graph::Graph& graph, std::size_t i) {
  const auto marginals = graph::Marginals::compute(graph);
  if (!marginals) return HUGE_VAL;
  const graph::Variable pose{graph::Variable::Kind::Pose, i};
  return std::sqrt(marginals->joint({&pose, 1})(5, 5));
}

TEST(Compass, ADriftSeenTwiceIsForetold) {
  // 6 °/min of gyroscope bias; the true heading is told after one and after two minutes, as walls do.
  Odometry odometry{{}};
  graph::Graph graph = stand(181, odometry, [](double t) { return 0.1 * kDegree * t; });
  EXPECT_NEAR(heading_error(graph, 180), 18.0 * kDegree, 1e-6);
  tell_heading(graph, 60), tell_heading(graph, 120);
  ASSERT_TRUE(graph::optimize(graph, {}).usable);
  EXPECT_NEAR(heading_error(graph, 60), 0.0, 1.0 * kDegree);
  EXPECT_NEAR(heading_error(graph, 90), 0.0, 2.0 * kDegree);
  EXPECT_NEAR(heading_error(graph, 180), 0.0, 6.0 * kDegree) << "a third of what odometry alone would be off by";
}

TEST(Compass, WhatMetalDidIsUndoneOnceItIsLeft) {
  // Drawn away by up to 17° for half a minute, and back again: what was traced there is known, and nothing after it.
  const double most = 20.0 * kDegree * (1.0 - std::exp(-2.0));
  const auto pull = [most](double t) {
    if (t < 30.0) return 0.0;
    return t < 60.0 ? 20.0 * kDegree * (1.0 - std::exp(-(t - 30.0) / 15.0)) : most * std::exp(-(t - 60.0) / 15.0);
  };
  const auto error_long_after = [&](const MapperConfig::Odometry& config) {
    Odometry odometry{config};
    graph::Graph graph = stand(181, odometry, pull);
    odometry.suspect_heading(30.0, 68.0, graph);
    tell_heading(graph, 30), tell_heading(graph, 60);
    EXPECT_TRUE(graph::optimize(graph, {}).usable);
    EXPECT_NEAR(heading_error(graph, 60), 0.0, 1.5 * kDegree);
    return std::abs(heading_error(graph, 180));
  };
  MapperConfig::Odometry random_walk;
  random_walk.heading_return_s = 1e6;
  EXPECT_NEAR(error_long_after(random_walk), most, 0.2 * most) << "the heading is believed to stay where it was drawn";
  EXPECT_LT(error_long_after({}), 0.4 * most);
}

TEST(Compass, ThePassingErrorIsBounded) {
  MapperConfig::Odometry config;
  config.north_rate_rad_per_s = config.north_rad_per_sqrt_s = 1e-5;
  Odometry odometry{config};
  const graph::Graph graph = stand(600, odometry, [](double) { return 0.0; });
  // Stationary: the driving noise times √(τ/2), seen from the first pose, which is off as much.
  const double stationary = config.heading_rad_per_sqrt_s * std::sqrt(0.5 * config.heading_return_s);
  EXPECT_NEAR(heading_sigma_of(graph, 300), std::hypot(stationary, config.north_sigma_rad), 0.1 * stationary);
  EXPECT_NEAR(heading_sigma_of(graph, 599), heading_sigma_of(graph, 300), 0.02 * stationary);
}

TEST(Compass, ANewWorldHasANorthOfItsOwn) {
  graph::Graph graph;
  Odometry odometry{{}};
  const auto add = [&](KeyPoseId id, double heading, bool anew) {
    KeyPose k;
    k.id = id;
    k.time_s = id;
    k.T_odom_pelvis = level_pose({anew || id < 40 ? 5.0 - 5.0 * anew : 0.0, 0, 1}, heading);
    k.discontinuity = anew;
    odometry.add(k, graph);
  };
  for (KeyPoseId i = 0; i < 40; ++i) add(i, 0.2, false);
  add(40, -1.1, true);
  for (KeyPoseId i = 41; i < 60; ++i) add(i, -1.1, false);
  ASSERT_TRUE(graph::optimize(graph, {}).usable);
  EXPECT_NEAR(heading_of(graph.poses.back().q), 0.2, 0.02) << "the wearer did not turn, the suit's world did";
  const double north = graph.scalars[graph.compasses.back().north];
  EXPECT_NEAR(north, 1.3, 0.02);

  turn_norths(graph, 40, 0.5);
  EXPECT_NEAR(graph.scalars[graph.compasses.back().north], north + 0.5, 1e-12);
  EXPECT_NEAR(graph.scalars[graph.compasses.front().north], 0.0, 0.02) << "that of the world before stays";
}

}  // namespace
}  // namespace kinemap
