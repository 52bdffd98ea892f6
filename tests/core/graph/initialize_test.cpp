// SPDX-License-Identifier: Apache-2.0
#include "core/graph/initialize.hpp"

#include <gtest/gtest.h>

#include "core/graph/optimizer.hpp"
#include "tests/core/graph/scene.hpp"

namespace kinemap::graph {
namespace {

double largest_difference(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max({largest, (a[i].p - b[i].p).norm(), so3_log(a[i].q.conjugate() * b[i].q).norm()});
  }
  return largest;
}

/// Random poses, each joined to the one before and to one further back, measured to `noise` (rad, m).
Graph random_pose_graph(std::size_t poses, double noise, unsigned seed) {
  test::Random random(seed);
  Graph g;
  for (std::size_t i = 0; i < poses; ++i) g.poses.push_back(random.pose(5.0));
  const auto join = [&](std::size_t i, std::size_t j) {
    BetweenFactor f;
    f.i = i, f.j = j;
    f.T_i_j = g.poses[i].inverse() * g.poses[j];
    f.T_i_j = {f.T_i_j.p + random.noise(noise), (f.T_i_j.q * so3_exp(random.noise(noise))).normalized()};
    g.between.push_back(f);
  };
  for (std::size_t i = 1; i < poses; ++i) {
    join(i - 1, i);
    if (i >= 6) join(i, i - 6);
  }
  return g;
}

Graph without_start(Graph graph, unsigned seed) {
  test::Random random(seed);
  for (std::size_t i = 1; i < graph.poses.size(); ++i) graph.poses[i] = random.pose(50.0);
  return graph;
}

TEST(ChordalStart, IsExactForExactMeasurementsFromAnyStart) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Graph truth = random_pose_graph(60, 0.0, seed);
    Graph graph = without_start(truth, seed + 50);
    EXPECT_GT(largest_rotation_error(graph), 1.0);
    ASSERT_TRUE(chordal_start(graph));
    EXPECT_LT(largest_difference(graph.poses, truth.poses), 1e-9);
    EXPECT_LT(largest_rotation_error(graph), 1e-9);
  }
}

TEST(ChordalStart, LeadsToTheOptimumThatTheTruthLeadsTo) {
  const Graph truth = random_pose_graph(80, 0.05, 3);
  OptimizerOptions options;
  options.function_tolerance = 1e-12;
  Graph from_truth = truth, from_chordal = without_start(truth, 4);
  ASSERT_TRUE(optimize(from_truth, options).usable);
  ASSERT_TRUE(chordal_start(from_chordal));
  EXPECT_LT(largest_rotation_error(from_chordal), 0.5);
  ASSERT_TRUE(optimize(from_chordal, options).usable);
  EXPECT_LT(largest_difference(from_truth.poses, from_chordal.poses), 1e-4);
}

TEST(ChordalStart, EachPartKeepsItsFirstPoseOrThatOfItsPrior) {
  const Graph truth = random_pose_graph(20, 0.0, 5);
  Graph graph = truth;
  std::erase_if(graph.between, [](const BetweenFactor& f) { return (f.i < 10) != (f.j < 10); });
  graph.priors.push_back({14, truth.poses[14], Matrix6::Identity()});
  test::Random random(6);
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    if (i != 0) graph.poses[i] = random.pose();
  }
  ASSERT_TRUE(chordal_start(graph));
  EXPECT_LT(largest_difference(graph.poses, truth.poses), 1e-9);
}

TEST(ChordalStart, RefusesFaultyGraphsAndGraphsWithLandmarks) {
  Graph graph = random_pose_graph(5, 0.0, 1);
  graph.between[0].j = 77;
  EXPECT_FALSE(chordal_start(graph));
  Graph scene = test::make_scene({}).truth;
  const Eigen::Vector3d before = scene.poses[3].p;
  EXPECT_FALSE(chordal_start(scene));
  EXPECT_EQ(scene.poses[3].p, before);
}

TEST(ChordalStart, GraphsWithoutEdgesStay) {
  Graph graph;
  EXPECT_TRUE(chordal_start(graph));
  graph.poses = {Pose{}, level_pose({1.0, 2.0, 3.0}, 0.4)};
  EXPECT_TRUE(chordal_start(graph));
  EXPECT_EQ(graph.poses[1].p, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(largest_rotation_error(graph), 0.0);
}

}  // namespace
}  // namespace kinemap::graph
