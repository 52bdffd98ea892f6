// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/occupancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Cell = OccupancyGrid::Cell;

Cell cell_at(const OccupancyGrid& grid, double x, double y) {
  return grid.at(static_cast<std::size_t>(std::floor((x - grid.origin.x()) / grid.resolution_m)),
                 static_cast<std::size_t>(std::floor((y - grid.origin.y()) / grid.resolution_m)));
}

TEST(Occupancy, WalkedIsFreeAndThingsAreInTheWay) {
  const OccupancyGrid grid = occupancy_grid(sample_map());
  EXPECT_EQ(grid.resolution_m, 0.05);
  EXPECT_NEAR(std::remainder(grid.origin.x(), 0.05), 0.0, 1e-9) << "cells stay where they are as the map grows";
  EXPECT_EQ(cell_at(grid, 0.52, 1.02), Cell::Free) << "on the way";
  EXPECT_EQ(cell_at(grid, 0.52, 1.22), Cell::Free) << "within the body's reach";
  EXPECT_EQ(cell_at(grid, 0.52, 1.32), Cell::Unknown);
  EXPECT_EQ(cell_at(grid, 4.02, 0.52), Cell::Occupied) << "the wall";
  EXPECT_EQ(cell_at(grid, 4.02, 1.22), Cell::Free) << "its doorway";
  EXPECT_EQ(cell_at(grid, 1.23, 1.02), Cell::Occupied) << "the table, though the way leads over it";
  EXPECT_EQ(cell_at(grid, 2.02, 0.22), Cell::Occupied) << "the chair";
  EXPECT_EQ(cell_at(grid, 2.02, 2.52), Cell::Unknown) << "an inferred wall";
}

TEST(Occupancy, NothingIsFreeBehindAWall) {
  MapSnapshot map = sample_map();
  map.trajectory = {{0, 0.0, level_pose({3.9, 2.0, 0.95}, 0.0), {}}, {1, 1.0, level_pose({3.9, 2.5, 0.95}, 0.0), {}}};
  const OccupancyGrid grid = occupancy_grid(map);
  EXPECT_EQ(cell_at(grid, 3.72, 2.22), Cell::Free);
  EXPECT_EQ(cell_at(grid, 4.12, 2.22), Cell::Unknown);
  map.objects.erase(map.objects.begin());
  map.rooms.clear();
  EXPECT_EQ(cell_at(occupancy_grid(map), 4.12, 2.22), Cell::Free) << "without the wall";
}

TEST(Occupancy, StaysBoundedHoweverFarThingsAre) {
  MapSnapshot map = sample_map();
  MapObject& chair = map.objects.back();
  chair.pose.p.x() = 9000.0;
  chair.pose.p.y() = -4000.0;
  const OccupancyGrid grid = occupancy_grid(map);
  EXPECT_LE(grid.cells.size(), 4000000U);
  EXPECT_EQ(grid.cells.size(), grid.columns * grid.rows);
  EXPECT_GT(grid.resolution_m, 1.0);
}

TEST(Occupancy, AnEmptyMapIsUnknown) {
  const OccupancyGrid grid = occupancy_grid({});
  EXPECT_EQ(grid.cells.size(), 400U);
  EXPECT_EQ(std::count(grid.cells.begin(), grid.cells.end(), Cell::Unknown), 400);
}

}  // namespace
}  // namespace kinemap
