// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/odometry.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

KeyPose at(KeyPoseId id, double x, double z) {
  KeyPose k;
  k.id = id;
  k.time_s = id;
  k.T_odom_pelvis.p = {x, 0.0, z};
  k.path_m = id > 0 ? 0.2 : 0.0;
  k.p_pelvis_stance = Eigen::Vector3d(0.0, 0.1, -0.95);
  return k;
}

TEST(Odometry, FirstKeyPoseIsTheMapFrame) {
  Odometry odometry{{}};
  graph::Graph graph;
  KeyPose first = at(0, 1.5, 0.95);
  first.T_odom_pelvis.q = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  odometry.add(first, graph);
  ASSERT_EQ(graph.poses.size(), 1u);
  EXPECT_EQ(graph.poses[0].p, first.T_odom_pelvis.p);
  EXPECT_EQ(graph.priors.size(), 1u);
  EXPECT_TRUE(graph.between.empty());
}

TEST(Odometry, VerticalDriftIsTakenOutByTheFloor) {
  Odometry odometry{{}};
  graph::Graph graph;
  for (KeyPoseId i = 0; i < 50; ++i) odometry.add(at(i, 0.2 * i, 0.95 + 0.004 * i), graph);  // 20 cm over 10 m
  EXPECT_NEAR(graph.poses.back().p.z(), 0.95, 1e-9);
  EXPECT_NEAR(odometry.floor_z(), 0.0, 1e-9);
  EXPECT_EQ(graph.floors.size(), 50u);
}

TEST(Odometry, AStairLeadsToAnotherLevelAndBack) {
  Odometry odometry{{}};
  graph::Graph graph;
  KeyPoseId id = 0;
  double z = 0.95, x = 0.0;
  const auto walk = [&](int n, double rise) {
    for (int i = 0; i < n; ++i) odometry.add(at(id++, x += 0.2, z += rise), graph);
  };
  walk(5, 0.0);
  walk(16, 0.17);
  walk(6, 0.0);
  EXPECT_NEAR(odometry.floor_z(), 16 * 0.17, 1e-6);
  walk(16, -0.17);
  walk(6, 0.005);
  EXPECT_NEAR(odometry.floor_z(), 0.0, 1e-6)
      << "the ground floor is the ground floor again, whatever drifted on the way";
}

TEST(Odometry, NoiseGrowsWithWayTimeAndTurn) {
  const MapperConfig::Odometry config;
  KeyPose from = at(0, 0, 1), to = at(1, 0.2, 1);
  const auto base = odometry_sqrt_information(from, to, config);
  KeyPose farther = to, later = to, turned = to, restarted = to;
  farther.path_m = 2.0;
  later.time_s = 10.0;
  turned.turn_rad = 3.0;
  restarted.discontinuity = true;
  EXPECT_LT(odometry_sqrt_information(from, farther, config)(0, 0), base(0, 0));
  EXPECT_LE(odometry_sqrt_information(from, restarted, config)(0, 0), 1.0);
  const double heading = heading_sigma(from, to, false, config);
  EXPECT_GT(heading_sigma(from, later, false, config), heading);
  EXPECT_GT(heading_sigma(from, to, true, config), heading);
  EXPECT_GT(heading_sigma(from, turned, false, config), heading);
}

TEST(Odometry, AResetOfTheSuitsWorldMovesNobody) {
  Odometry odometry{{}};
  graph::Graph graph;
  for (KeyPoseId i = 0; i < 20; ++i) odometry.add(at(i, 2.0 + 0.2 * i, 0.95), graph);
  KeyPose reset = at(20, 0.0, 0.90);
  reset.time_s = 19.0 + 1.0 / 120.0;
  reset.T_odom_pelvis.q = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ());
  reset.path_m = 0.0;
  reset.discontinuity = true;
  odometry.add(reset, graph);
  EXPECT_NEAR((graph.poses[20].p - graph.poses[19].p).norm(), 0.0, 1e-9);
  EXPECT_NEAR(graph.poses[20].q.angularDistance(graph.poses[19].q), 0.0, 1e-6);
  const auto& information = graph.between.back().sqrt_information;
  EXPECT_GT(information(0, 0), 20.0) << "in one frame a body moves by centimetres";
  EXPECT_GT(information(5, 5), 20.0);
  // The wearer walks on, in the new world along another axis.
  KeyPose next = reset;
  next.id = 21, next.time_s = 20.0, next.path_m = 0.2, next.discontinuity = false;
  next.T_odom_pelvis.p += next.T_odom_pelvis.q * Eigen::Vector3d(0.2, 0, 0);
  odometry.add(next, graph);
  EXPECT_NEAR((graph.poses[21].p - graph.poses[19].p - Eigen::Vector3d(0.2, 0, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(odometry.floor_z(), 0.0, 1e-9) << "the new world's floor is the same floor";
}

TEST(Odometry, ARestartLeavesPlaceAndHeadingOpenButNotTheLevel) {
  Odometry odometry{{}};
  graph::Graph graph;
  for (KeyPoseId i = 0; i < 20; ++i) odometry.add(at(i, 2.0 + 0.2 * i, 0.95), graph);
  KeyPose restarted = at(20, 0.3, 0.95);
  restarted.time_s = 19.0 + 60.0;
  restarted.discontinuity = true;
  odometry.add(restarted, graph);
  EXPECT_NEAR((graph.poses[20].p - graph.poses[19].p).norm(), 0.0, 1e-9) << "nobody knows better";
  const auto& information = graph.between.back().sqrt_information;
  EXPECT_NEAR(information(0, 0), 0.1, 1e-9);
  EXPECT_NEAR(information(5, 5), 0.5, 1e-9);
  EXPECT_GT(information(3, 3), 50.0);
}

TEST(Odometry, ABreakInTheRecordOfOneWorldIsWhereTheSuitSays) {
  KeyPose from = at(0, 2.0, 0.95), to = at(1, 8.0, 0.95);
  to.time_s = 10.0;
  to.discontinuity = true;  // key poses were lost from a journal
  EXPECT_NEAR(odometry_step(from, to, {}).p.x(), 6.0, 1e-9);
}

TEST(Odometry, NearTheOriginAWorldMayHaveBegunAnew) {
  KeyPose from = at(0, 1.2, 0.95), to = at(1, 0.1, 0.95);
  to.time_s = 1.5;
  to.discontinuity = true;
  EXPECT_NEAR(odometry_step(from, to, {}).p.norm(), 0.0, 1e-9) << "within reach, but that says nothing here";
}

TEST(Odometry, StandingFeetCorrectTheWay) {
  const MapperConfig::Odometry config;
  const KeyPose from = at(0, 0.0, 0.95);
  KeyPose to = at(1, 0.2, 0.95);
  const auto deaf = odometry_sqrt_information(from, to, config);
  EXPECT_EQ(deaf(5, 5), 0.0) << "the heading is the compass' matter";
  to.slip = Slip{0.03, {0.01, -0.02}, to.time_s - from.time_s, 0.0};
  const Pose step = odometry_step(from, to, config);
  EXPECT_NEAR(heading_of(step.q), 0.03, 1e-9);
  const double w = 0.022 * 0.022 / (0.022 * 0.022 + 0.02 * 0.02);  // two measurements, by their weights
  EXPECT_NEAR(step.p.x(), 0.2 + w * 0.01, 1e-9);
  EXPECT_NEAR(step.p.y(), -w * 0.02, 1e-9);
  const auto heard = odometry_sqrt_information(from, to, config);
  EXPECT_GT(heard(0, 0), deaf(0, 0));
  EXPECT_NEAR(1.0 / heard(5, 5), 0.012 * std::sqrt(to.time_s - from.time_s), 1e-9);

  KeyPose at_odds = to, seldom = to;
  at_odds.slip->apart_rad = 0.1;
  EXPECT_NEAR(1.0 / odometry_sqrt_information(from, at_odds, config)(5, 5), 0.1, 0.01) << "feet that disagree";
  seldom.slip->stood_s *= 0.3;
  EXPECT_EQ(odometry_sqrt_information(from, seldom, config)(5, 5), 0.0);
  EXPECT_NEAR(heading_of(odometry_step(from, seldom, config).q), 0.0, 1e-9);
}

/// Noise of the heading on the way to key pose `k`.
double heading_noise(const graph::Graph& graph, KeyPoseId k) {
  return step_sigma(graph, graph.between.at(k - 1)).heading_rad;
}

TEST(Odometry, ADisturbedFieldWidensTheHeadingAndForSomeTimeAfter) {
  MapperConfig::Odometry config;
  config.magnetic_after_s = 3.0;
  Odometry odometry{config};
  graph::Graph graph;
  for (KeyPoseId i = 0; i < 20; ++i) {
    KeyPose k = at(i, 0.2 * i, 0.95);
    k.field_disturbed = i == 8 || i == 9;
    odometry.add(k, graph);
  }
  const double usual = heading_noise(graph, 1);
  for (KeyPoseId i = 1; i < 20; ++i) {
    if (i >= 8 && i <= 12)
      EXPECT_GT(heading_noise(graph, i), 1.1 * usual) << i;
    else
      EXPECT_DOUBLE_EQ(heading_noise(graph, i), usual) << i;
  }
}

TEST(Odometry, WhatTheSuitSaysOfTheFieldCountsMoreThanTheGuess) {
  for (const bool told : {false, true}) {
    Odometry odometry{{}};
    graph::Graph graph;
    const auto add = [&](KeyPoseId i) {
      KeyPose k = at(i, 0.2 * i, 0.95);
      if (told) k.field_disturbed = false;
      odometry.add(k, graph);
    };
    for (KeyPoseId i = 0; i < 10; ++i) add(i);
    odometry.suspect_heading(4.5, 14.5, graph);
    for (KeyPoseId i = 10; i < 20; ++i) add(i);
    const double usual = heading_noise(graph, 1);
    for (KeyPoseId i = 1; i < 20; ++i) {
      if (!told && i >= 5 && i <= 14)
        EXPECT_GT(heading_noise(graph, i), 1.1 * usual) << i;
      else
        EXPECT_DOUBLE_EQ(heading_noise(graph, i), usual) << i;
    }
  }
}

}  // namespace
}  // namespace kinemap
