// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/relocate.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

Landmark thing(LandmarkKind kind, double x, double y, double z, double heading, double length = 0.0,
               double width = 0.0) {
  Landmark out;
  out.kind = kind;
  out.x = {x, y, z, heading, length, width, 0.0};
  return out;
}

std::vector<Landmark> room() {
  return {thing(LandmarkKind::Table, 1, 2, 0.72, 0.1, 1.6, 0.8), thing(LandmarkKind::Screen, 3, -1, 1.2, 1.6, 1.3, 0.8),
          thing(LandmarkKind::Seat, 2, 1, 0.46, -2.0), thing(LandmarkKind::Table, 5, 4, 0.75, 0.1, 1.2, 0.7)};
}

/// Things seen before and after a break of a minute; those after it by a suit whose world is another one by `T`.
MapState two_parts(const std::vector<Landmark>& before, const std::vector<Landmark>& after, const Pose& T_part_map) {
  MapState state;
  auto& graph = state.graph;
  for (std::size_t i = 0; i < 4; ++i) graph.poses.push_back(level_pose({double(i), 0, 0.95}, 0.0));
  for (std::size_t i = 2; i < 4; ++i) graph.poses[i] = T_part_map * graph.poses[i];
  for (std::size_t i = 1; i < 4; ++i) {
    graph::BetweenFactor way;
    way.i = i - 1, way.j = i;
    way.T_i_j = graph.poses[i - 1].inverse() * graph.poses[i];
    way.sqrt_information.diagonal() << 50, 50, 50, 100, 100, 100;
    if (i == 2) way.sqrt_information.diagonal() << 0.1, 0.1, 3, 100, 100, 0.5;
    graph.between.push_back(way);
  }
  const auto add = [&](Landmark landmark, KeyPoseId key_pose) {
    state.observations.push_back({graph.landmarks.size(), key_pose, 0, 0, 0, 0.0, 1.0});
    state.landmarks.push_back({static_cast<std::uint32_t>(graph.landmarks.size() + 1), 1, 0.0, 1.0, 0.0});
    graph.landmarks.push_back(landmark);
  };
  for (const Landmark& landmark : before) add(landmark, 1);
  for (Landmark landmark : after) {
    const Eigen::Vector3d p = T_part_map * Eigen::Vector3d(landmark.x[0], landmark.x[1], landmark.x[2]);
    landmark.x[0] = p.x(), landmark.x[1] = p.y(), landmark.x[3] = wrap_angle(landmark.x[3] + heading_of(T_part_map.q));
    add(landmark, 3);
  }
  return state;
}

const Pose kElsewhere = level_pose({-7, 3, 0}, 2.2);

TEST(Relocate, ThreeThingsThatLieToEachOtherAsBeforeJoinTheParts) {
  const auto things = room();
  MapState state = two_parts(things, {things[0], things[1], things[2]}, kElsewhere);
  ASSERT_EQ(open_break(state.graph), 1u);
  const auto T_map_part = find_relocation(state);
  ASSERT_TRUE(T_map_part);
  EXPECT_NEAR((T_map_part->p - kElsewhere.inverse().p).norm(), 0.0, 1e-6);
  EXPECT_NEAR(T_map_part->q.angularDistance(kElsewhere.inverse().q), 0.0, 1e-6);
  const auto before = state.graph.poses[1];
  relocate(state, *T_map_part);
  EXPECT_FALSE(open_break(state.graph));
  EXPECT_EQ(state.graph.poses[1].p, before.p) << "the map before the break stays";
  EXPECT_NEAR((state.graph.poses[3].p - Eigen::Vector3d(3, 0, 0.95)).norm(), 0.0, 1e-6);
  for (std::size_t k = 0; k < 3; ++k)
    for (const std::size_t i : {0, 1, 2}) EXPECT_NEAR(state.graph.landmarks[4 + k].x[i], things[k].x[i], 1e-6);
}

TEST(Relocate, TwoThingsAreNotEnough) {
  const auto things = room();
  EXPECT_FALSE(find_relocation(two_parts(things, {things[0], things[2]}, kElsewhere)));
}

TEST(Relocate, ThingsThatLieOtherwiseAreOtherThings) {
  auto other = room();
  other[1].x[0] += 1.5, other[2].x[1] -= 1.2;
  EXPECT_FALSE(find_relocation(two_parts(room(), {other[0], other[1], other[2]}, kElsewhere)));
}

TEST(Relocate, RowsThatLookAlikeAreLeftOpen) {
  std::vector<Landmark> row;  // a row of like desks with a chair each
  for (int n = 0; n < 5; ++n) {
    row.push_back(thing(LandmarkKind::Table, 2.0 * n, 0, 0.72, 0, 1.6, 0.8));
    row.push_back(thing(LandmarkKind::Seat, 2.0 * n, -0.8, 0.46, 1.57));
  }
  EXPECT_FALSE(find_relocation(two_parts(row, {row[2], row[3], row[4], row[5]}, kElsewhere)));
}

TEST(Relocate, WithoutABreakThereIsNothingToJoin) {
  const auto things = room();
  MapState state = two_parts(things, things, kElsewhere);
  state.graph.between[1].sqrt_information = state.graph.between[0].sqrt_information;
  EXPECT_FALSE(open_break(state.graph));
  EXPECT_FALSE(find_relocation(state));
  EXPECT_TRUE(beyond_break(state).empty());
}

}  // namespace
}  // namespace kinemap
