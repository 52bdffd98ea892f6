// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/noise.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "core/graph/optimizer.hpp"
#include "core/mapper/odometry.hpp"

namespace kinemap {
namespace {

constexpr int kPoses = 200;

struct Suit {
  double heading = 1.0;  ///< it wanders so many times as much as the configuration expects
  double contact = 1.0;  ///< the same of what the hand says
};

/// A winding walk round a table that the hand touches all the while. Every `known_every` key poses the true pose is
/// known, as it is after a closure; 0: never.
graph::Graph optimised_walk(const Suit& suit, int known_every) {
  const MapperConfig::Odometry config;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  graph::Graph graph;
  Odometry odometry(config);
  Pose T_map_pelvis, T_odom_pelvis;
  KeyPose before;
  graph.touch_points.push_back({.fixed = true});
  graph.landmarks.push_back({.kind = graph::LandmarkKind::Table, .x = {0.0, 0.0, 0.75, 0.0, 9.0, 9.0}});
  for (const int known : {0, 1, 3, 4, 5})
    graph.landmark_priors.push_back({0, known, graph.landmarks[0].x[static_cast<std::size_t>(known)], 0.01});
  for (int i = 0; i < kPoses; ++i) {
    const double turn = 0.1 + 0.3 * normal(random);
    KeyPose key_pose;
    key_pose.id = static_cast<KeyPoseId>(i);
    key_pose.time_s = 0.3 * i;
    key_pose.path_m = 0.2;
    key_pose.turn_rad = std::abs(turn);
    if (i > 0) {
      const double error = suit.heading * heading_sigma(before, key_pose, false, config) * normal(random);
      T_map_pelvis = T_map_pelvis * level_pose({0.2, 0.0, 0.0}, turn);
      T_odom_pelvis = T_odom_pelvis * level_pose({0.2, 0.0, 0.0}, turn + error);
    }
    key_pose.T_odom_pelvis = T_odom_pelvis;
    odometry.add(key_pose, graph);
    graph::ContactFactor contact;
    contact.i = static_cast<std::size_t>(i);
    contact.sigma_plane_m = 0.03;
    Eigen::Vector3d touched = T_map_pelvis * Eigen::Vector3d(0.4, 0.0, 0.0);
    touched.z() = 0.75 + suit.contact * contact.sigma_plane_m * normal(random);
    contact.T_i_hand.p = T_map_pelvis.inverse() * touched;
    graph.contacts.push_back(contact);
    if (known_every > 0 && i > 0 && i % known_every == 0)
      graph.priors.push_back({static_cast<std::size_t>(i), T_map_pelvis, 200.0 * graph::Matrix6::Identity()});
    before = key_pose;
  }
  EXPECT_TRUE(graph::optimize(graph, {.max_iterations = 50}).usable);
  return graph;
}

/// The same walk without the table.
graph::Graph untouched(graph::Graph graph) {
  graph.contacts.clear();
  for (auto& landmark : graph.landmarks) landmark.active = false;
  return graph;
}

TEST(Noise, MayBeAnythingUntilContactsOrLoopsTell) {
  EXPECT_GT(most_heading_noise(untouched(optimised_walk({0.1, 0.3}, 0))), 1.5);
}

TEST(Noise, OfTheHeadingIsHeardFromContactsAndLoops) {
  EXPECT_LT(most_heading_noise(optimised_walk({0.1, 0.3}, 0)), 0.5);  // a hand so still is of a good suit
  EXPECT_LT(most_heading_noise(optimised_walk({0.1, 0.3}, 10)), 0.3);
  EXPECT_GT(most_heading_noise(optimised_walk({1.5, 1.3}, 0)), 1.0);
  EXPECT_GT(most_heading_noise(optimised_walk({1.5, 1.3}, 10)), 1.0);
}

TEST(Noise, OfHeadingsAndContactsFollowsTheirErrors) {
  const auto usual = estimate_noise(optimised_walk({1.0, 1.0}, 10));
  const auto arm = estimate_noise(optimised_walk({1.0, 0.5}, 10)),
             heading = estimate_noise(optimised_walk({3.0, 1.0}, 10));
  EXPECT_NEAR(arm.contact / usual.contact, 0.5, 0.1);
  EXPECT_GT(arm.heading / usual.heading, 0.7);
  EXPECT_NEAR(heading.heading / usual.heading, 3.0, 0.7);
  EXPECT_NEAR(heading.contact / usual.contact, 1.0, 0.1);
}

TEST(Noise, ASuitIsGoodOrBadAsAWhole) {
  const auto good = estimate_noise(optimised_walk({0.1, 0.3}, 10)),
             usual = estimate_noise(optimised_walk({0.4, 0.7}, 10)),
             bad = estimate_noise(optimised_walk({1.5, 1.3}, 10));
  EXPECT_LT(good.way, 0.7 * usual.way);
  EXPECT_GT(bad.way, 1.4 * usual.way);
  EXPECT_NEAR(usual.way, 1.0, 0.3);
}

TEST(Noise, OfASuitThatTouchedNothingIsTheUsualOne) {
  const auto noise = estimate_noise(untouched(optimised_walk({1.0, 1.0}, 0)));
  EXPECT_NEAR(noise.contact, 1.0, 1e-3);
  EXPECT_NEAR(noise.way, 1.0, 1e-3);
  EXPECT_NEAR(noise.heading, 0.5, 1e-2);
}

}  // namespace
}  // namespace kinemap
