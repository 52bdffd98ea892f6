// SPDX-License-Identifier: Apache-2.0
#include "core/graph/variance_components.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/graph/optimizer.hpp"
#include "tests/core/graph/scene.hpp"

namespace kinemap::graph {
namespace {

using test::make_scene;

/// Headings that walk at random with steps of `noise` × 0.02 rad, seen at each pose with 0.01 rad: level poses at the
/// origin whose gravity and priors leave the heading alone free.
Graph heading_walk(std::size_t poses, double noise) {
  test::Random random(7);
  Graph g;
  g.scalars = {0.0, 0.0};
  g.scalar_priors = {{0, 0.0, 0.01}};
  double heading = 0.0;
  for (std::size_t i = 0; i < poses; ++i) {
    heading += random.normal(0.02 * noise);
    const double seen = heading + random.normal(0.01);
    g.poses.push_back(level_pose(Eigen::Vector3d::Zero(), seen));
    PriorFactor prior{i, level_pose(Eigen::Vector3d::Zero(), seen), Matrix6::Identity() * 1e3};
    prior.sqrt_information(5, 5) = 100.0;
    g.priors.push_back(prior);
    const Eigen::Quaterniond suit = Eigen::Quaterniond::Identity();
    if (i == 0)
      g.compasses.push_back({0, 0, 1, suit, suit, 0.0, 10.0});
    else
      g.compasses.push_back({i - 1, i, 1, suit, suit, 1.0, 0.02});
  }
  return g;
}

TEST(VarianceComponents, FindHowLargeTheHeadingsErrorIs) {
  for (const double noise : {0.3, 1.0, 3.0}) {
    Graph g = heading_walk(400, noise);
    for (int round = 0; round < 12; ++round) {
      ASSERT_TRUE(optimize(g, {.max_iterations = 20}).usable);
      const auto found = variance_components(g);
      ASSERT_TRUE(found);
      g.noise.heading *= std::sqrt(found->heading.squares / found->heading.redundancy);
    }
    EXPECT_NEAR(g.noise.heading / noise, 1.0, 0.2) << noise;
  }
}

TEST(VarianceComponents, ExpectTheSquaresOfScenesWhoseNoiseIsAsSaid) {
  double squares = 0.0, redundancy = 0.0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Graph g = make_scene({.poses = 30, .noise = 1.0, .seed = seed}).truth;
    for (ContactFactor& f : g.contacts) f.sigma_corner_m = f.sigma_edge_m;  // the scene's corners are as good
    ASSERT_TRUE(optimize(g, {.max_iterations = 20}).usable);
    const auto found = variance_components(g);
    ASSERT_TRUE(found);
    squares += found->contact.squares, redundancy += found->contact.redundancy;
  }
  EXPECT_NEAR(squares / redundancy, 1.0, 0.05);
}

TEST(VarianceComponents, ContactsThatErrTogetherCountByTheirShare) {
  Graph g = make_scene({.poses = 20, .noise = 1.0}).truth;
  const auto whole = variance_components(g);
  double halves = 0.0;
  for (ContactFactor& f : g.contacts) {
    f.share = 0.5;
    halves += 0.5 * (g.landmarks[f.landmark].kind == LandmarkKind::Wall
                         ? 1
                         : 1 + (f.edge != Edge::None) + (f.corner != Edge::None));
  }
  const auto shared = variance_components(g);
  ASSERT_TRUE(whole && shared);
  EXPECT_NEAR(whole->contact.redundancy - shared->contact.redundancy, halves, 1e-9);
  EXPECT_EQ(whole->contact.squares, shared->contact.squares);
}

TEST(VarianceComponents, TheRemainderOfALossIsNoResidual) {
  Graph plain = make_scene({.poses = 20, .noise = 1.0}).truth;
  Graph robust = plain;
  for (ContactFactor& f : robust.contacts) f.loss = {Loss::Kind::Huber, 1e6};
  const auto a = variance_components(plain), b = variance_components(robust);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->contact.squares, b->contact.squares, 1e-9 * a->contact.squares);
}

TEST(VarianceComponents, AVariableWithoutFactorsLeavesNone) {
  Graph g = make_scene({.poses = 10}).truth;
  g.scalars.push_back(0.0);
  EXPECT_FALSE(variance_components(g));
}

}  // namespace
}  // namespace kinemap::graph
