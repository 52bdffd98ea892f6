// SPDX-License-Identifier: Apache-2.0
#include "core/graph/fold.hpp"

#include <gtest/gtest.h>

#include "core/graph/marginals.hpp"
#include "core/graph/optimizer.hpp"
#include "tests/core/graph/scene.hpp"

namespace kinemap::graph {
namespace {

using test::make_scene;
using test::Scene;

/// A scene of which all poses are known, at its optimum.
Graph known_way(const Loss& loss) {
  Graph graph = make_scene({.noise = 1.0, .loss = loss}).truth;
  graph.touch_points[1].fixed = false;
  graph.first_free_pose = graph.poses.size();
  EXPECT_TRUE(optimize(graph, {}).usable);
  return graph;
}

Graph folded(const Graph& graph) {
  auto factors = fold(graph);
  EXPECT_TRUE(factors);
  Graph out = graph;
  out.contacts.clear(), out.seats.clear();
  if (factors) out.folded = *std::move(factors);
  return out;
}

Eigen::MatrixXd covariance(const Graph& graph) {
  const auto marginals = Marginals::compute(graph);
  EXPECT_TRUE(marginals);
  std::vector<Variable> all;
  for (std::size_t k = 0; k < graph.landmarks.size(); ++k) all.push_back({Variable::Kind::Landmark, k});
  for (std::size_t k = 0; k < graph.touch_points.size(); ++k) all.push_back({Variable::Kind::Touch, k});
  return marginals ? marginals->joint(all) : Eigen::MatrixXd{};
}

class Fold : public testing::TestWithParam<Loss> {};

TEST_P(Fold, SaysWhatItsContactsAndSeatsSaid) {
  const Graph graph = known_way(GetParam()), less = folded(graph);
  EXPECT_EQ(less.folded.size(), 2u * 4u + 1u) << "two hands touched four things, and there is a seat";
  EXPECT_NEAR(cost(less), cost(graph), 1e-9 * cost(graph));
  const auto before = covariance(graph), after = covariance(less);
  EXPECT_LT((after - before).norm(), 1e-6 * before.norm());
}

TEST_P(Fold, IsDrawnAsTheyWere) {
  Graph graph = known_way(GetParam());
  Graph less = folded(graph);
  for (Graph* g : {&graph, &less}) {
    for (const auto& [landmark, index] : {std::pair{Scene::kWallA, 1}, {Scene::kTable, 0}, {Scene::kSeat, 1}}) {
      const double now = g->landmarks[landmark].x[static_cast<std::size_t>(index)];
      g->landmark_priors.push_back({landmark, index, now + 0.02, 0.005});
    }
    EXPECT_TRUE(optimize(*g, {}).usable);
  }
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l)
    for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(less.landmarks[l].x[k], graph.landmarks[l].x[k], 0.003) << l << k;
}

TEST_P(Fold, FoldedAgainSaysTheSame) {
  const Graph graph = known_way(GetParam()), once = folded(graph), twice = folded(once);
  EXPECT_NEAR(cost(twice), cost(graph), 1e-9 * cost(graph));
  EXPECT_LT((covariance(twice) - covariance(graph)).norm(), 1e-6 * covariance(graph).norm());
  for (std::size_t k = 0; k < once.folded.size(); ++k)
    EXPECT_NEAR(twice.folded[k].weighted_squares, once.folded[k].weighted_squares, 1e-9);
}

TEST_P(Fold, KnowsALandmarkByItsOtherName) {
  Graph graph = folded(known_way(GetParam()));
  const double before = cost(graph);
  Landmark& wall = graph.landmarks[Scene::kWallA];
  const Eigen::Vector3d normal(std::cos(wall.x[0]), std::sin(wall.x[0]), 0.0);
  const Eigen::Vector3d anchor = wall.anchor + Eigen::Vector3d(0.4, -1.1, 0.2);
  wall.x[1] += normal.dot(wall.anchor - anchor);
  wall.anchor = anchor;
  Landmark& table = graph.landmarks[Scene::kTable];
  table.x[3] -= std::numbers::pi / 2.0;
  std::swap(table.x[4], table.x[5]);
  for (FoldedFactor& f : graph.folded)
    if (f.landmark == Scene::kTable) f.quarter_turns = 1;
  EXPECT_NEAR(cost(graph), before, 1e-9 * before);
  Graph found = graph;
  wall.x[0] += 0.02, wall.x[1] += 0.03, table.x[3] -= 0.03, table.x[4] += 0.05;
  EXPECT_GT(cost(graph), before + 1.0);
  EXPECT_TRUE(optimize(graph, {}).usable);
  EXPECT_TRUE(optimize(found, {}).usable);
  EXPECT_NEAR(cost(graph), cost(found), 1e-4 * before);
}

INSTANTIATE_TEST_SUITE_P(Losses, Fold, testing::Values(Loss{}, Loss{Loss::Kind::Cauchy, 2.0}));

}  // namespace
}  // namespace kinemap::graph
