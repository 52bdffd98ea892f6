// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/topology.hpp"

#include <gtest/gtest.h>

#include "tools/kinemap/alignment.hpp"

namespace kinemap::eval {
namespace {

/// A room of 6 × 4 m, walls 1 to 4 round it from the lower one on, and a table 5 in it; each touched once.
Truth room() {
  Truth truth;
  truth.rooms = {{{0, 0}, {6, 0}, {6, 4}, {0, 4}}};
  const Eigen::Vector3d middles[] = {{3, 0, 1}, {6, 2, 1}, {3, 4, 1}, {0, 2, 1}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    TruthObject wall;
    wall.id = i + 1;
    wall.pose.p = middles[i];
    wall.room = 0;
    truth.objects.push_back(wall);
  }
  TruthObject table;
  table.id = 5;
  table.type = ObjectType::Table;
  table.klass = Class::Table;
  truth.objects.push_back(table);
  for (const TruthObject& object : truth.objects)
    truth.visits.push_back({object.id, 10.0 * object.id, 10.0 * object.id + 5.0});
  return truth;
}

/// The map with ids from 11 on, and one room of its walls.
MapSnapshot map_of(const Truth& truth) {
  MapSnapshot map;
  for (const TruthVisit& visit : truth.visits) {
    MapObject object;
    object.id = visit.object + 10;
    object.visits = {{visit.begin_s, visit.end_s}};
    map.objects.push_back(object);
  }
  map.rooms.push_back({});
  map.rooms[0].wall_ids = {13, 12, 11, 14};  // the other way round, from another corner on
  return map;
}

TopologyCheck check(const MapSnapshot& map, const Truth& truth) {
  return check_topology(map, truth, check_association(map.objects, truth.visits, {}));
}

TEST(Topology, AMapIsRightWhateverItsMeasures) {
  const Truth truth = room();
  const TopologyCheck result = check(map_of(truth), truth);
  EXPECT_TRUE(result.right()) << result.wrong.front();
  EXPECT_EQ(result.rooms, 1U);
  EXPECT_EQ(result.rooms_found, 1U);
}

TEST(Topology, WallsNextToOthersMakeAnotherRoom) {
  const Truth truth = room();
  MapSnapshot map = map_of(truth);
  std::swap(map.rooms[0].wall_ids[0], map.rooms[0].wall_ids[1]);
  const TopologyCheck result = check(map, truth);
  EXPECT_EQ(result.rooms_found, 0U);
  ASSERT_EQ(result.wrong.size(), 2U) << "one is missing, one is there that should not be";
}

TEST(Topology, SaysWhatIsMissingDoubleOrTakenForAnother) {
  const Truth truth = room();
  MapSnapshot map = map_of(truth);
  map.objects[4].visits[0] = {30.0, 34.0};  // the table's object is made of a visit to wall 3
  map.objects[0].visits.push_back({20.0, 24.0});
  const auto wrong = check(map, truth).wrong;
  const std::vector<std::string> expected = {"table 5 is missing", "object 15 of the map is a second wall 3",
                                             "object 11 of the map, wall 1, has a visit to wall 2"};
  EXPECT_EQ(wrong, expected);
}

TEST(Topology, ARoomWithAnUntouchedWallIsNotAsked) {
  Truth truth = room();
  truth.untouched.push_back(truth.objects[1]);
  truth.objects.erase(truth.objects.begin() + 1);
  truth.visits.erase(truth.visits.begin() + 1);
  MapSnapshot map = map_of(truth);
  map.rooms.clear();
  const TopologyCheck result = check(map, truth);
  EXPECT_TRUE(result.right());
  EXPECT_EQ(result.rooms, 0U);
  map.rooms.push_back({});  // the missing wall was inferred
  map.rooms[0].wall_ids = {11, 13, 14};
  EXPECT_TRUE(check(map, truth).right());
  EXPECT_EQ(unknown_ends(truth, 1), 1U);
  EXPECT_EQ(unknown_ends(truth, 4), 0U);
}

TEST(Scale, IsTheRatioOfTheExtents) {
  const std::vector<Eigen::Vector3d> map = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}};
  std::vector<Eigen::Vector3d> truth;
  for (const Eigen::Vector3d& p : map) truth.push_back(level_pose({3, 1, 0}, 0.7) * Eigen::Vector3d(1.05 * p));
  EXPECT_NEAR(*scale_between(map, truth), 1.05, 1e-12);
  EXPECT_FALSE(scale_between({}, {}));
}

}  // namespace
}  // namespace kinemap::eval
