// SPDX-License-Identifier: Apache-2.0
#include "protocol/floor.hpp"

#include <gtest/gtest.h>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

std::vector<TrajectoryPose> way(const std::vector<Eigen::Vector2d>& points) {
  std::vector<TrajectoryPose> trajectory;
  for (const auto& p : points)
    trajectory.push_back({static_cast<KeyPoseId>(trajectory.size()), 0.0, level_pose({p.x(), p.y(), 1.0}, 0.0), {}});
  return trajectory;
}

bool walked(const CellGrid& grid, double x, double y) {
  const Eigen::Vector2d cell = (Eigen::Vector2d(x, y) - grid.origin) / grid.cell_m;
  if (cell.minCoeff() < 0 || cell.x() >= static_cast<double>(grid.columns) ||
      cell.y() >= static_cast<double>(grid.rows))
    return false;
  return grid.at(static_cast<std::size_t>(cell.x()), static_cast<std::size_t>(cell.y())) != 0;
}

TEST(WalkedFloor, IsWithinReachOfTheWay) {
  const auto grid = walked_floor(way({{0, 0}, {1.5, 0}, {1.5, 1.5}}), 0.05, 0.3);
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {0.75, 0.25}, {1.5, 0.8}, {-0.2, 0.0}, {1.7, 1.5}})
    EXPECT_TRUE(walked(grid, x, y)) << x << ", " << y;
  for (const auto& [x, y] : {std::pair(0.75, 0.4), {0.0, 1.0}, {-0.4, 0.0}, {1.0, 1.0}})
    EXPECT_FALSE(walked(grid, x, y)) << x << ", " << y;
}

TEST(WalkedFloor, ARestartLeavesAGap) {
  const auto grid = walked_floor(way({{0, 0}, {10, 0}}), 0.1, 0.3);
  EXPECT_TRUE(walked(grid, 0, 0));
  EXPECT_TRUE(walked(grid, 10, 0));
  EXPECT_FALSE(walked(grid, 5, 0));
}

TEST(WalkedFloor, IsBoundedInMemory) {
  const auto grid = walked_floor(way({{0, 0}, {5000, 3000}}), 0.1, 0.3);
  EXPECT_LE(grid.cells.size(), 1000000U);
  EXPECT_GE(static_cast<double>(grid.columns) * grid.cell_m, 5000.0);
  EXPECT_TRUE(walked_floor({}, 0.1, 0.3).cells.empty());
}

TEST(FloorHeight, IsTheLowestCornerOfTheWalls) {
  MapSnapshot map = sample_map();
  EXPECT_EQ(floor_height(map), 0.0);
  EXPECT_EQ(floor_height({}), 0.0);
  MapObject below = map.objects.front();
  below.id = 9;
  for (auto& corner : *below.corners) corner.z() -= 3.0;
  map.objects.push_back(below);
  EXPECT_EQ(floor_height(map), -3.0);
  EXPECT_EQ(floor_height(map, &map.rooms.front()), 0.0) << "of its own walls";
}

}  // namespace
}  // namespace kinemap
