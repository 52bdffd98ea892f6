// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/settled.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

/// A way of so many steps, its first pose certain; every so many poses a place is known to 5 cm, up to pose `known`.
graph::Graph way(std::size_t poses, std::size_t known) {
  graph::Graph graph;
  graph::Matrix6 step = graph::Matrix6::Identity();
  step.diagonal() << 50.0, 50.0, 50.0, 100.0, 100.0, 100.0;
  for (std::size_t i = 0; i < poses; ++i) {
    graph.poses.push_back(level_pose({0.2 * static_cast<double>(i), 0.0, 0.0}, 0.0));
    if (i > 0) graph.between.push_back({i - 1, i, level_pose({0.2, 0.0, 0.0}, 0.0), step, {}});
    if (i % 20 == 0 && i < known) graph.priors.push_back({i, graph.poses[i], graph::Matrix6::Identity() * 20.0});
  }
  return graph;
}

std::size_t first_unsettled(const graph::Graph& graph) {
  const auto marginals = graph::Marginals::compute(graph);
  EXPECT_TRUE(marginals);
  return marginals ? first_unsettled_pose(graph, *marginals) : 0;
}

TEST(Settled, NothingInASessionOfHalfAnHour) { EXPECT_EQ(first_unsettled(way(4400, 4400)), 0u); }

TEST(Settled, WhatIsWellKnownAndLongAgo) {
  auto graph = way(5000, 5000);
  const std::size_t settled = first_unsettled(graph);
  EXPECT_GT(settled, 1900u);
  EXPECT_LE(settled, 2000u);
  graph.first_free_pose = settled;
  EXPECT_EQ(first_unsettled(graph), settled) << "in steps";
}

TEST(Settled, NotWhatNoClosureHasTiedDown) {
  const std::size_t settled = first_unsettled(way(5000, 1000));
  EXPECT_GT(settled, 900u);
  EXPECT_LT(settled, 1500u);
}

}  // namespace
}  // namespace kinemap
