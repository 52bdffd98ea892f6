// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/walls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/mapper/rooms.hpp"

namespace kinemap {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// A map with exact planes, made by a wearer who walks from place to place and touches walls from 0.45 m.
class Visit {
 public:
  Visit() { state.graph.touch_points.emplace_back(); }

  Visit& walk_to(Eigen::Vector2d p) {
    auto& poses = state.graph.poses;
    const Eigen::Vector3d to(p.x(), p.y(), 0.95);
    if (poses.empty()) poses.push_back({to, Eigen::Quaterniond::Identity()});
    const Eigen::Vector3d from = poses.back().p;
    const int steps = static_cast<int>((to - from).norm() / 0.2) + 1;
    for (int k = 1; k <= steps; ++k) poses.push_back({from + (to - from) * k / steps, Eigen::Quaterniond::Identity()});
    return *this;
  }

  /// Touches a wall from a to b; the room is on the left of that way. Returns the landmark.
  std::size_t touch(Eigen::Vector2d a, Eigen::Vector2d b) {
    const std::size_t k = state.graph.landmarks.size();
    const Eigen::Vector2d along = (b - a).normalized(), normal(-along.y(), along.x());
    graph::Landmark wall;
    wall.x[0] = std::atan2(normal.y(), normal.x());
    wall.anchor = {0.5 * (a.x() + b.x()), 0.5 * (a.y() + b.y()), 1.2};
    state.graph.landmarks.push_back(wall);
    add_visit(k, a, b, normal);
    return k;
  }

  void touch_all(const Points& polygon, double margin) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d a = polygon[k], b = polygon[(k + 1) % polygon.size()];
      const Eigen::Vector2d along = (b - a).normalized();
      touch(a + margin * along, b - margin * along);
    }
  }

  /// A table with its sides along the axes, drawn from where the wearer is.
  void table(Eigen::Vector2d centre, double length, double width) {
    graph::Landmark table;
    table.kind = graph::LandmarkKind::Table;
    table.x = {centre.x(), centre.y(), 0.75, 0.0, length, width, 0.0};
    state.graph.landmarks.push_back(table);
    record(state.graph.landmarks.size() - 1, state.graph.contacts.size());
  }

  MapState state;

 private:
  void add_visit(std::size_t wall, const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& normal) {
    const std::size_t first = state.graph.contacts.size();
    for (int k = 0; k <= 10; ++k) {
      const Eigen::Vector2d p = a + (b - a) * k / 10.0;
      walk_to(p + 0.45 * normal);
      graph::ContactFactor contact;
      contact.i = state.graph.poses.size() - 1;
      contact.landmark = wall;
      contact.T_i_hand.p = Eigen::Vector3d(p.x(), p.y(), 1.2) - state.graph.poses.back().p;
      state.graph.contacts.push_back(contact);
    }
    record(wall, first);
  }
  void record(std::size_t landmark, std::size_t first_contact) {
    state.landmarks.push_back({static_cast<std::uint32_t>(landmark + 1), 1, 0.0, 0.0, 0.0});
    ObservationRecord visit;
    visit.landmark = landmark;
    visit.key_pose = static_cast<KeyPoseId>(state.graph.poses.size() - 1);
    visit.first_contact = first_contact;
    visit.contacts = state.graph.contacts.size() - first_contact;
    state.observations.push_back(visit);
  }
};

const MapperConfig::Walls kConfig;
const Points kRectangle{{0, 0}, {4, 0}, {4, 3}, {0, 3}};

void expect_lengths(const std::vector<FiniteWall>& walls, const std::vector<double>& lengths, double tolerance = 1e-6) {
  ASSERT_EQ(walls.size(), lengths.size());
  for (std::size_t k = 0; k < walls.size(); ++k) EXPECT_NEAR(walls[k].length(), lengths[k], tolerance) << "wall " << k;
}

std::vector<Room> rooms_of(const Visit& visit) {
  return find_rooms(visit.state, cut_walls(visit.state, kConfig), kConfig);
}

TEST(CutWalls, RectangleAndItsRoom) {
  Visit visit;
  visit.touch_all(kRectangle, 0.4);
  expect_lengths(cut_walls(visit.state, kConfig), {4, 3, 4, 3});
  const auto rooms = rooms_of(visit);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 12.0, 1e-9);
  EXPECT_EQ(rooms[0].wall_ids.size(), 4u);
  EXPECT_TRUE(rooms[0].inferred_sides.empty());
}

TEST(CutWalls, LShapeHasAnInnerCorner) {
  Visit visit;
  visit.touch_all({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 5}, {0, 5}}, 0.3);
  expect_lengths(cut_walls(visit.state, kConfig), {6, 3, 3, 2, 3, 5});
  const auto rooms = rooms_of(visit);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 24.0, 1e-9);
}

/// Two rooms side by side, joined by a doorway at y = 2.2 in a partition 0.12 m thick.
Visit flat(double y0_right, double y1_right) {
  Visit visit;
  visit.walk_to({1, 1}).touch({0.4, 0}, {3.6, 0});
  visit.touch({4, 0.3}, {4, 1.6});
  visit.touch({3.6, 3}, {0.4, 3});
  visit.touch({0, 2.6}, {0, 0.4});
  visit.walk_to({3.5, 2.2}).walk_to({4.7, 2.2});
  visit.touch({4.12, 1.6}, {4.12, y0_right + 0.3});
  visit.touch({4.5, y0_right}, {7.6, y0_right});
  visit.touch({8, y0_right + 0.4}, {8, y1_right - 0.4});
  visit.touch({7.6, y1_right}, {4.5, y1_right});
  visit.walk_to({4.7, 2.2}).walk_to({3.5, 2.2});
  return visit;
}

TEST(CutWalls, TwoFacesOfAPartitionBelongToTheirOwnRooms) {
  const Visit visit = flat(-0.5, 3.5);
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3, 4, 3.88, 4, 3.88});
  const auto rooms = find_rooms(visit.state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 2u);
  EXPECT_NEAR(rooms[0].area_m2, 12.0, 1e-9);
  EXPECT_NEAR(rooms[1].area_m2, 3.88 * 4, 1e-9);
}

TEST(CutWalls, CollinearWallsOfTwoRoomsStayTwo) {
  const Visit visit = flat(0.0, 3.0);
  expect_lengths(cut_walls(visit.state, kConfig), {4, 3, 4, 3, 3, 3.88, 3, 3.88});
}

/// The two faces of a partition are touched on different sides of its doorway, and the second room in two visits that
/// touch none of its walls twice.
TEST(CutWalls, ADoorwayBetweenTheTouchedPartsOfAPartition) {
  Visit visit;
  visit.touch({0.3, 0}, {3.7, 0});
  visit.touch({4, 0.3}, {4, 0.9});
  visit.touch({3.7, 3}, {0.3, 3});
  visit.touch({0, 2.7}, {0, 0.3});
  visit.walk_to({3.4, 1.7}).walk_to({4.8, 1.7});
  visit.touch({4.42, 0}, {7.7, 0});
  visit.touch({8, 0.3}, {8, 2.7});
  visit.walk_to({4.8, 1.7}).walk_to({2.0, 1.7}).walk_to({4.8, 1.7});
  visit.touch({7.7, 3}, {4.42, 3});
  visit.touch({4.12, 2.8}, {4.12, 2.5});
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3, 3.88, 3, 3.88, 3});
  EXPECT_EQ(find_rooms(visit.state, walls, kConfig).size(), 2u);
}

TEST(FindDoorways, OneForBothFacesAndAllTimes) {
  const Visit visit = flat(-0.5, 3.5);
  const auto walls = cut_walls(visit.state, kConfig);
  const auto doorways = find_doorways(visit.state, walls, find_rooms(visit.state, walls, kConfig));
  ASSERT_EQ(doorways.size(), 1u);
  EXPECT_NEAR((doorways[0].position - Eigen::Vector2d(4.06, 2.2)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(std::abs(std::cos(doorways[0].heading_rad)), 1.0, 1e-9);
  EXPECT_EQ(doorways[0].room_ids, (std::vector<std::uint32_t>{1, 2}));
}

TEST(FindDoorways, NoneWhereOneOnlyTurnsRoundAnInnerCorner) {
  Visit visit;
  visit.touch_all({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 5}, {0, 5}}, 0.3);
  visit.walk_to({2.5, 4.5}).walk_to({2.6, 2.6}).walk_to({5.5, 2.5});
  const auto walls = cut_walls(visit.state, kConfig);
  EXPECT_TRUE(find_doorways(visit.state, walls, find_rooms(visit.state, walls, kConfig)).empty());
}

TEST(CutWalls, AnObliqueWall) {
  Visit visit;
  visit.touch_all({{0, 0}, {5, 0}, {4, 3}, {0, 3}}, 0.3);
  expect_lengths(cut_walls(visit.state, kConfig), {5, std::hypot(1.0, 3.0), 4, 3});
}

TEST(CutWalls, AnEndThatMeetsNobodyStaysWhereItWasTouched) {
  Visit visit;
  visit.touch({0, 0}, {3, 0});
  const auto alone = cut_walls(visit.state, kConfig);
  expect_lengths(alone, {3});
  EXPECT_EQ(alone[0].head.kind, EndKind::Open);
  EXPECT_GT(alone[0].head.sigma_m, 1.0);  // it may go on
  EXPECT_TRUE(rooms_of(visit).empty());
  const double far = 3 + kConfig.join_max_m + 0.5;  // too far to be prolonged to
  visit.touch({far, 0.3}, {far, 2});
  EXPECT_EQ(cut_walls(visit.state, kConfig)[0].head.kind, EndKind::Open);
}

TEST(CutWalls, AnOpenEndGoesOnWhereTheWearerWalksAlongTheWall) {
  Visit visit;
  visit.touch({0, 0}, {1.5, 0});
  visit.walk_to({3.2, 0.6});
  const auto along = cut_walls(visit.state, kConfig);
  ASSERT_EQ(along.size(), 1U);
  EXPECT_EQ(along[0].head.kind, EndKind::Open);
  EXPECT_NEAR(along[0].head.s - along[0].tail.s, 3.5, 0.3);
  visit.walk_to({2.4, 0.6}).walk_to({2.4, -0.8});  // through where it would go on
  const auto through = cut_walls(visit.state, kConfig);
  EXPECT_NEAR(through[0].head.s - through[0].tail.s, 1.5, 0.3);
}

TEST(CutWalls, TwoWallsAndACornerAreNoRoom) {
  Visit visit;
  visit.touch({0.4, 0}, {3.6, 0});
  visit.touch({4, 0.4}, {4, 2.5});
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {3.6, 2.5});
  EXPECT_EQ(walls[0].head.kind, EndKind::Corner);
  EXPECT_EQ(walls[1].head.kind, EndKind::Open);
  EXPECT_TRUE(rooms_of(visit).empty());
}

TEST(CutWalls, AWallThatNobodyTouchedIsInferredBehindTheTableBeforeIt) {
  Visit visit;
  visit.touch({0.4, 0}, {2.5, 0});  // a table over the whole of the right wall keeps one from both its corners
  visit.table({3.6, 1.5}, 0.8, 2.6);
  visit.touch({2.4, 3}, {0.4, 3});
  visit.touch({0, 2.6}, {0, 0.4});
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {4, 4, 3}, 0.05);
  EXPECT_EQ(walls[0].head.kind, EndKind::Inferred);
  EXPECT_GT(walls[0].head.sigma_m, 0.03);
  const auto rooms = find_rooms(visit.state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_EQ(rooms[0].wall_ids.size(), 3u);
  EXPECT_EQ(rooms[0].inferred_sides, std::vector<std::size_t>{1});
  EXPECT_NEAR(rooms[0].polygon[1].x(), 4.0, 0.05);
  EXPECT_NEAR(rooms[0].polygon[2].x(), 4.0, 0.05);
}

TEST(CutWalls, AWallThatNobodyTouchedIsInferredBehindWhereTheWearerWalked) {
  Visit visit;
  visit.touch({0.4, 0}, {1.5, 0});
  visit.walk_to({2.6, 1.5});
  visit.touch({1.4, 3}, {0.4, 3});
  visit.touch({0, 2.6}, {0, 0.4});
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {3, 3, 3}, 0.2);
  EXPECT_EQ(walls[0].head.kind, EndKind::Inferred);
  EXPECT_GT(walls[0].head.sigma_m, 0.2);
}

TEST(CutWalls, StretchesOfOneWallAreOneWall) {
  Visit visit;
  visit.touch({0.3, 0}, {1.5, 0});
  visit.touch({2.8, 0.02}, {4.7, 0.02});  // a cupboard in between, and some drift
  visit.touch({5, 0.3}, {5, 2.7});
  visit.touch({4.7, 3}, {0.3, 3});
  visit.touch({0, 2.7}, {0, 0.3});
  const auto walls = cut_walls(visit.state, kConfig);
  ASSERT_EQ(walls.size(), 4u);
  EXPECT_EQ(walls[0].landmark, 1u) << "the longer stretch gives the plane";
  EXPECT_EQ(walls[0].stretches, (std::vector<std::size_t>{0, 1}));
  EXPECT_NEAR(walls[0].length(), 5.0, 1e-6);
  const auto rooms = find_rooms(visit.state, walls, kConfig);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 5.0 * 2.98, 1e-6);
}

TEST(CutWalls, OverlappingStretchesOfOneWallAreOneWall) {
  Visit visit;
  visit.touch_all(kRectangle, 0.4);
  visit.touch({1.0, 0.05}, {2.5, 0.05});  // the same wall again, not recognised
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3});
  EXPECT_EQ(walls[0].stretches, (std::vector<std::size_t>{0, 4}));
}

TEST(CutWalls, AStubInTheRoomDisturbsNoCorner) {
  Visit visit;
  visit.touch_all(kRectangle, 0.4);
  visit.touch({1.5, 1.4}, {2.3, 1.4});  // one side of a cupboard
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {4, 3, 4, 3, 0.8});
  EXPECT_EQ(rooms_of(visit).size(), 1u);
}

/// Points round a rectangle seen from outside, clockwise: the room is about it.
Points outside_of(Eigen::Vector2d lo, Eigen::Vector2d hi) { return {lo, {lo.x(), hi.y()}, hi, {hi.x(), lo.y()}}; }

/// Walking round its ends within a doorway's reach splits the way in two, until the wearer comes to where he was
/// before.
TEST(CutWalls, APartitionThatStandsFreeEndsWhereItWasTouched) {
  Visit visit;
  visit.touch_all({{0, 0}, {9, 0}, {9, 8}, {0, 8}}, 0.4);
  visit.walk_to({0.5, 6}).touch({1.31, 3.65}, {3.69, 3.65});
  visit.walk_to({4.2, 4.1}).walk_to({4.2, 3.1});
  visit.touch({3.6, 3.55}, {1.31, 3.55});
  visit.walk_to({0.5, 0.5}).walk_to({5.2, 1.0}).walk_to({5.2, 2.0});
  visit.touch({6.45, 1.95}, {6.45, 4.0});
  visit.walk_to({6.5, 4.6});
  visit.touch({6.55, 4.05}, {6.55, 1.95});
  visit.walk_to({8.5, 1});
  expect_lengths(cut_walls(visit.state, kConfig), {9, 8, 9, 8, 2.38, 2.38, 2.1, 2.1}, 1e-3);
  const auto rooms = rooms_of(visit);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 72.0, 1e-9);
}

TEST(CutWalls, TheFacesOfAFreePartitionMayCrossByDrift) {
  Visit visit;
  visit.touch_all({{0, 0}, {9, 0}, {9, 8}, {0, 8}}, 0.4);
  visit.walk_to({0.5, 5}).touch({3, 3.97}, {6, 3.97});  // its back, 6 cm through its front
  visit.walk_to({6.7, 4.5}).walk_to({6.7, 3.5});
  visit.touch({6, 4.03}, {3, 4.03});
  visit.walk_to({0.5, 0.5});
  const auto walls = cut_walls(visit.state, kConfig);
  expect_lengths(walls, {9, 8, 9, 8, 3, 3});
  EXPECT_EQ(walls[4].head.kind, EndKind::Inferred);
  EXPECT_EQ(rooms_of(visit).size(), 1u);
}

TEST(CutWalls, APartitionThatEndsInTheRoom) {
  Visit visit;
  visit.touch_all({{0, 0}, {3, 0}, {3, 2}, {3.1, 2}, {3.1, 0}, {6, 0}, {6, 4}, {0, 4}}, 0.3);
  auto& landmarks = visit.state.graph.landmarks;
  landmarks[2].active = false;  // nobody touches the narrow end
  expect_lengths(cut_walls(visit.state, kConfig), {3, 1.7, 1.7, 2.9, 4, 6, 4}, 1e-6);
  const auto rooms = rooms_of(visit);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 24.0 - 0.17, 1e-9);
  EXPECT_EQ(rooms[0].inferred_sides.size(), 1u);
}

TEST(CutWalls, APillarIsNoRoom) {
  Visit visit;
  visit.touch_all({{0, 0}, {6, 0}, {6, 5}, {0, 5}}, 0.4);
  visit.touch_all(outside_of({2.0, 2.0}, {2.8, 2.6}), 0.1);
  expect_lengths(cut_walls(visit.state, kConfig), {6, 5, 6, 5, 0.6, 0.8, 0.6, 0.8});
  const auto rooms = rooms_of(visit);
  ASSERT_EQ(rooms.size(), 1u);
  EXPECT_NEAR(rooms[0].area_m2, 30.0, 1e-9);
}

TEST(CutWalls, NoWallsNoRooms) { EXPECT_TRUE(cut_walls(MapState{}, kConfig).empty()); }

}  // namespace
}  // namespace kinemap
