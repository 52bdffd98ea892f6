// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/walls.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/mapper/closure.hpp"

namespace kinemap {
namespace {

/// Adds a wall with contacts from a to b (level, m); the room is on the left of that way.
std::size_t add_wall(MapState& state, Eigen::Vector2d a, Eigen::Vector2d b) {
  const std::size_t k = state.graph.landmarks.size();
  const Eigen::Vector2d along = (b - a).normalized();
  graph::Landmark wall;
  wall.x[0] = std::atan2(along.x(), -along.y());  // 90° left of the way
  wall.anchor = {0.5 * (a.x() + b.x()), 0.5 * (a.y() + b.y()), 1.2};
  state.graph.landmarks.push_back(wall);
  state.landmarks.push_back({static_cast<std::uint32_t>(k + 1), 1, 0.0, 0.0, 0.0});
  ObservationRecord visit;
  visit.landmark = k;
  visit.first_contact = state.graph.contacts.size();
  visit.contacts = 2;
  for (const auto& p : {a, b}) {
    graph::ContactFactor contact;
    contact.landmark = k;
    contact.T_i_hand.p = {p.x(), p.y(), 1.2};
    state.graph.contacts.push_back(contact);
  }
  state.observations.push_back(visit);
  return k;
}

MapState empty() {
  MapState state;
  state.graph.poses.emplace_back();
  state.graph.touch_points.emplace_back();
  return state;
}

/// Walls along a counter-clockwise polygon, touched from `margin` after each corner to `margin` before the next.
MapState room(const std::vector<Eigen::Vector2d>& polygon, double margin, MapState state = empty()) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const Eigen::Vector2d along = (b - a).normalized();
    add_wall(state, a + margin * along, b - margin * along);
  }
  return state;
}

const MapperConfig::Walls kConfig;

void expect_lengths(const std::vector<FiniteWall>& walls, const std::vector<double>& lengths) {
  ASSERT_EQ(walls.size(), lengths.size());
  for (std::size_t k = 0; k < walls.size(); ++k)
    EXPECT_NEAR(walls[k].head - walls[k].tail, lengths[k], 1e-9) << "wall " << k;
}

TEST(CutWalls, RectangleAndItsRoom) {
  const auto state = room({{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 0.4);
  const auto walls = cut_walls(state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3});
  const auto rooms = find_rooms(state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 12.0, 1e-9);
  EXPECT_EQ(rooms[0].wall_ids.size(), 4u);
}

TEST(CutWalls, LShapeHasAnInnerCorner) {
  const auto state = room({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 5}, {0, 5}}, 0.3);
  const auto walls = cut_walls(state, kConfig);
  expect_lengths(walls, {6, 3, 3, 2, 3, 5});
  const auto rooms = find_rooms(state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 24.0, 1e-9);
}

TEST(CutWalls, TwoFacesOfAPartitionBelongToTheirOwnRooms) {
  auto state = room({{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 0.4);
  state = room({{4.12, 0}, {8, 0}, {8, 3}, {4.12, 3}}, 0.4, state);
  const auto walls = cut_walls(state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3, 3.88, 3, 3.88, 3});
  const auto rooms = find_rooms(state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 2u);
  EXPECT_NEAR(rooms[0].area_m2, 12.0, 1e-9);
  EXPECT_NEAR(rooms[1].area_m2, 3.88 * 3, 1e-9);
}

TEST(CutWalls, AnObliqueWall) {
  const auto state = room({{0, 0}, {5, 0}, {4, 3}, {0, 3}}, 0.3);
  expect_lengths(cut_walls(state, kConfig), {5, std::hypot(1.0, 3.0), 4, 3});
}

TEST(CutWalls, AnEndThatMeetsNobodyStaysWhereItWasTouched) {
  auto state = empty();
  add_wall(state, {0, 0}, {3, 0});
  const auto alone = cut_walls(state, kConfig);
  expect_lengths(alone, {3});
  EXPECT_FALSE(alone[0].next);
  EXPECT_TRUE(find_rooms(state, alone, kConfig).empty());
  add_wall(state, {3 + kConfig.join_max_m + 0.5, 0.3},
           {3 + kConfig.join_max_m + 0.5, 2});  // too far to be prolonged to
  EXPECT_FALSE(cut_walls(state, kConfig)[0].next);
}

TEST(CutWalls, StretchesOfOneWallAreOneWall) {
  auto state = empty();
  add_wall(state, {0.3, 0}, {1.5, 0});
  add_wall(state, {2.8, 0.02}, {4.7, 0.02});  // a cupboard in between, and some drift
  add_wall(state, {5, 0.3}, {5, 2.7});
  add_wall(state, {4.7, 3}, {0.3, 3});
  add_wall(state, {0, 2.7}, {0, 0.3});
  const auto walls = cut_walls(state, kConfig);
  ASSERT_EQ(walls.size(), 4u);
  EXPECT_EQ(walls[0].landmark, 1u) << "the longer stretch gives the plane";
  EXPECT_EQ(walls[0].stretches, (std::vector<std::size_t>{0, 1}));
  EXPECT_NEAR(walls[0].head - walls[0].tail, 5.0, 1e-6);
  const auto rooms = find_rooms(state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 5.0 * 2.98, 1e-6);
}

TEST(CutWalls, CollinearWallsOfTwoRoomsStayTwo) {
  auto state = room({{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 0.4);
  state = room({{0, 3.12}, {4, 3.12}, {4, 6}, {0, 6}}, 0.4, state);
  expect_lengths(cut_walls(state, kConfig), {4, 3, 4, 3, 4, 2.88, 4, 2.88});
}

TEST(CutWalls, NoWallsNoRooms) { EXPECT_TRUE(cut_walls(empty(), kConfig).empty()); }

TEST(RightAngles, LeaveAnObliqueWallAlone) {
  const auto state = room({{0, 0}, {5, 0}, {4, 3}, {0, 3}}, 0.3);  // the second wall is 18° off
  const auto factors = right_angles(state, kConfig);
  EXPECT_EQ(factors.size(), 3u);
  for (const auto& f : factors) EXPECT_TRUE(f.a != 1 && f.b != 1);
  MapperConfig::Walls none;
  none.right_angle_sigma_rad = 0.0;
  EXPECT_TRUE(right_angles(state, none).empty());
}

}  // namespace
}  // namespace kinemap
