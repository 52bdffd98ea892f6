// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/walls.hpp"

#include <gtest/gtest.h>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Point = Eigen::Vector2d;

void expect_near(const Point& a, const Point& b) {
  EXPECT_LT((a - b).norm(), 1e-9) << a.transpose() << " " << b.transpose();
}

TEST(Walls, AreCutOpenAtTheirDoorways) {
  const auto stretches = wall_stretches(sample_map());
  ASSERT_EQ(stretches.size(), 5U) << "three of wall 1, two inferred sides";
  EXPECT_EQ(stretches[0].wall_id, 0U);
  expect_near(stretches[0].a, {4, 3});
  expect_near(stretches[0].b, {2, 3});
  expect_near(stretches[0].normal(), {0, -1});
  const auto wall = stretches_of(stretches, 1);
  ASSERT_EQ(wall.size(), 3U);
  const Point ends[] = {{4, 0}, {4, 0.8}, {4, 1.6}, {4, 3}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(wall[i].open, i == 1);
    expect_near(wall[i].a, ends[i]);
    expect_near(wall[i].b, ends[i + 1]);
    expect_near(wall[i].normal(), {-1, 0});
    EXPECT_EQ(wall[i].top_z, 2.5);
  }
  expect_near(wall[0].outline(0.1)[1], {4.1, 0});
}

TEST(Walls, ADoorwayOpensOnlyTheWallsItGoesThrough) {
  MapSnapshot map = sample_map();
  map.doorways = {{{4.2, 1.2}, 0.0, {}}};  // the way through, seen from the other face
  EXPECT_EQ(wall_stretches(map).size(), 5U);
  map.doorways = {{{4.6, 1.2}, 0.0, {}}};
  EXPECT_EQ(wall_stretches(map).size(), 3U) << "too far behind";
  map.doorways = {{{4.0, 1.2}, 1.5708, {}}};
  EXPECT_EQ(wall_stretches(map).size(), 3U) << "along the wall, not through it";
  map.doorways = {{{4.0, 0.1}, 0.0, {}}, {{4.0, 0.7}, 0.0, {}}};
  const auto stretches = wall_stretches(map);
  ASSERT_EQ(stretches.size(), 4U) << "two that overlap are one, and none is wider than the wall";
  EXPECT_TRUE(stretches[2].open);
  EXPECT_NEAR(stretches[2].length(), 1.1, 1e-9);
}

TEST(Walls, BacksMeetWhereFacesDo) {
  MapSnapshot map;
  for (const auto& [id, x, y, normal] :
       {std::tuple{1U, 2.0, 0.0, Eigen::Vector3d(0, 1, 0)}, std::tuple{2U, 2.0, 3.0, Eigen::Vector3d(-1, 0, 0)}}) {
    MapObject wall;
    wall.id = id;
    wall.plane = PlaneEquation{normal, 0.0};
    const Eigen::Vector3d from(id == 1 ? 0.0 : 2.0, 0, 0), to(x, y, 0), up(0, 0, 2.5);
    wall.corners = {{from, to, to + up, from + up}};
    map.objects.push_back(wall);
  }
  const auto stretches = wall_stretches(map);
  ASSERT_EQ(stretches.size(), 2U);
  expect_near(stretches[0].outline(0.1)[2], {2.1, -0.1});
  expect_near(stretches[1].outline(0.1)[1], {2.1, -0.1});
  expect_near(stretches[0].outline(0.1)[1], {0.0, -0.1});  // a free end
}

}  // namespace
}  // namespace kinemap
