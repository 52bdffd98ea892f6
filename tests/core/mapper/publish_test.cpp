// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/graph/marginals.hpp"
#include "core/mapper/odometry.hpp"

namespace kinemap {
namespace {

TEST(TypicalNoise, NarrowsTheHeadingAndLeavesARestartUnknown) {
  graph::Graph graph;
  graph::BetweenFactor walked, restarted;
  walked.sqrt_information = 20.0 * graph::Matrix6::Identity();
  restarted.sqrt_information = 0.5 * graph::Matrix6::Identity();
  graph.between = {walked, restarted};
  MapperConfig::Odometry config;
  config.typical_heading_share = 0.4;
  const graph::Graph typical = with_typical_noise(graph, config);
  EXPECT_DOUBLE_EQ(typical.between[0].sqrt_information(5, 5), 50.0);
  EXPECT_DOUBLE_EQ(typical.between[0].sqrt_information(0, 0), 20.0);
  EXPECT_DOUBLE_EQ(typical.between[1].sqrt_information(5, 5), 0.5);
}

}  // namespace
}  // namespace kinemap
