// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/extract.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "core/pose.hpp"
#include "tests/core/landmarks/contours.hpp"

namespace kinemap {
namespace {

using graph::Edge;
using graph::LandmarkKind;
using test::level_rectangle;
using test::trace;
using test::upright_rectangle;
using test::with_reach;

const LandmarkConfig kConfig;

std::vector<Eigen::Vector3d> round_trip(std::vector<Eigen::Vector3d> corners) {
  corners.push_back(corners.front());
  return corners;
}

double long_side(const graph::Landmark& l) { return std::max(l.x[4], l.x[5]); }
double short_side(const graph::Landmark& l) { return std::min(l.x[4], l.x[5]); }

class TableAtHeading : public testing::TestWithParam<double> {};

TEST_P(TableAtHeading, WholeContour) {
  const auto corners = level_rectangle({2.0, -1.0, 0.74}, GetParam(), 1.6, 0.8);
  const auto found = extract_landmarks(trace(round_trip(corners)), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  const auto& table = found.observations[0];
  EXPECT_EQ(table.landmark.kind, LandmarkKind::Table);
  EXPECT_TRUE(table.closed);
  EXPECT_NEAR(long_side(table.landmark), 1.6, 0.01);
  EXPECT_NEAR(short_side(table.landmark), 0.8, 0.01);
  EXPECT_NEAR(table.landmark.x[0], 2.0, 0.01);
  EXPECT_NEAR(table.landmark.x[1], -1.0, 0.01);
  EXPECT_NEAR(table.landmark.x[2], 0.74, 0.005);
}

TEST_P(TableAtHeading, TwoAdjacentSides) {
  const auto corners = level_rectangle({2.0, -1.0, 0.74}, GetParam(), 1.6, 0.8);
  const auto found = extract_landmarks(trace({corners[0], corners[1], corners[2]}), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  const auto& table = found.observations[0];
  EXPECT_FALSE(table.closed);
  EXPECT_NEAR(long_side(table.landmark), 1.6, 0.015);
  EXPECT_NEAR(short_side(table.landmark), 0.8, 0.015);
  EXPECT_NEAR(table.landmark.x[0], 2.0, 0.015);
  EXPECT_NEAR(table.landmark.x[1], -1.0, 0.015);
  // Both free ends are corners, on sides that nobody drew.
  EXPECT_EQ(std::count_if(table.labels.begin(), table.labels.end(),
                          [](const SideLabel& l) { return l.corner != Edge::None; }),
            2);
}

TEST_P(TableAtHeading, ThreeSides) {
  const auto corners = level_rectangle({2.0, -1.0, 0.74}, GetParam(), 1.6, 0.8);
  const auto found = extract_landmarks(trace({corners[3], corners[0], corners[1], corners[2]}), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  EXPECT_NEAR(long_side(found.observations[0].landmark), 1.6, 0.015);
  EXPECT_NEAR(short_side(found.observations[0].landmark), 0.8, 0.015);
}

TEST_P(TableAtHeading, StartedInTheMiddleOfASide) {
  const auto c = level_rectangle({2.0, -1.0, 0.74}, GetParam(), 1.6, 0.8);
  const Eigen::Vector3d middle = 0.5 * (c[0] + c[1]);
  const auto found = extract_landmarks(trace({middle, c[1], c[2], c[3], c[0], middle}), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  EXPECT_TRUE(found.observations[0].closed);
  EXPECT_NEAR(long_side(found.observations[0].landmark), 1.6, 0.01);
  EXPECT_NEAR(short_side(found.observations[0].landmark), 0.8, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Headings, TableAtHeading, testing::Values(0.0, 0.3, 0.78, 1.2, 2.0, 3.0, -0.7, -2.4));

TEST(Extract, TheReachToATableIsNotPartOfIt) {
  const auto corners = level_rectangle({1.2, 0.0, 0.74}, 0.2, 1.6, 0.8);
  // From the hanging hand, which is hardly lower than the table top.
  const auto points = with_reach(trace({corners[0], corners[1], corners[2]}), {0.2, -0.9, 0.70}, 0.7);
  const auto found = extract_landmarks(points, 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  EXPECT_NEAR(long_side(found.observations[0].landmark), 1.6, 0.05);
  EXPECT_NEAR(short_side(found.observations[0].landmark), 0.8, 0.05);
}

TEST(Extract, ScreenWithSideAndNormalTowardsTheWearer) {
  for (const double heading : {0.0, 1.0, 2.5, -2.0}) {
    const Eigen::Vector3d centre(1.0, 2.0, 1.3);
    const Eigen::Vector3d normal(std::cos(heading), std::sin(heading), 0.0);
    const auto corners = upright_rectangle(centre, heading, 1.4, 0.8);
    test::Contour contour;
    contour.body = centre + 0.6 * normal;
    const auto found = extract_landmarks(trace(round_trip(corners), contour), 0.0, kConfig);
    ASSERT_EQ(found.observations.size(), 1u) << found.reason;
    const auto& screen = found.observations[0].landmark;
    EXPECT_EQ(screen.kind, LandmarkKind::Screen);
    EXPECT_NEAR(wrap_angle(screen.x[3] - heading), 0.0, 0.03);
    EXPECT_NEAR(screen.x[4], 1.4, 0.01);
    EXPECT_NEAR(screen.x[5], 0.8, 0.01);
    EXPECT_NEAR((Eigen::Vector3d(screen.x[0], screen.x[1], screen.x[2]) - centre).norm(), 0.0, 0.02);
  }
}

TEST(Extract, WallStraightOrWaved) {
  for (const double wave : {0.0, 0.3}) {
    std::vector<Eigen::Vector3d> path;
    for (int i = 0; i <= 60; ++i) path.emplace_back(0.08 * i, 1.5, 1.2 + wave * std::sin(0.5 * i));
    const auto found = extract_landmarks(trace(path), 0.0, kConfig);
    ASSERT_EQ(found.observations.size(), 1u) << found.reason;
    const auto& wall = found.observations[0].landmark;
    EXPECT_EQ(wall.kind, LandmarkKind::Wall);
    EXPECT_NEAR(wrap_angle(wall.x[0] + std::numbers::pi / 2.0), 0.0, 0.01) << "the wearer is on the side of −y";
    EXPECT_NEAR(wall.anchor.y(), 1.5, 0.01);
  }
}

TEST(Extract, TwoWallsInOneGesture) {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i <= 40; ++i) path.emplace_back(0.08 * i, 1.5, 1.2 + 0.2 * std::sin(0.6 * i));
  for (int i = 1; i <= 40; ++i) path.emplace_back(3.2, 1.5 - 0.08 * i, 1.2 + 0.2 * std::sin(0.6 * i));
  const auto found = extract_landmarks(trace(path), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 2u) << found.reason;
  EXPECT_EQ(found.observations[0].landmark.kind, LandmarkKind::Wall);
  EXPECT_EQ(found.observations[1].landmark.kind, LandmarkKind::Wall);
  EXPECT_GT(std::abs(wrap_angle(found.observations[0].landmark.x[0] - found.observations[1].landmark.x[0])), 1.4);
}

void expect_walls(const Extraction& found, const std::vector<double>& headings) {
  ASSERT_EQ(found.observations.size(), headings.size()) << found.reason;
  for (std::size_t k = 0; k < headings.size(); ++k) {
    const auto& wall = found.observations[k].landmark;
    EXPECT_EQ(wall.kind, LandmarkKind::Wall);
    EXPECT_NEAR(wrap_angle(wall.x[0] - headings[k]), 0.0, 0.03) << "wall " << k;
  }
}

TEST(Extract, AllWallsOfARoomInOneGesture) {
  const double quarter = std::numbers::pi / 2.0;
  for (const double height : {0.95, 1.3}) {
    const auto room = trace(round_trip(level_rectangle({0, 0, height}, 0.0, 4.0, 3.0)));
    expect_walls(extract_landmarks(room, 0.0, kConfig), {quarter, 2 * quarter, -quarter, 0.0});
    const auto three = trace({{-2, -1.5, height}, {2, -1.5, height}, {2, 1.5, height}, {-2, 1.5, height}});
    expect_walls(extract_landmarks(three, 0.0, kConfig), {quarter, 2 * quarter, -quarter});
  }
}

TEST(Extract, WallsRoundAnOuterCornerInOneGesture) {
  const double h = 1.2, quarter = std::numbers::pi / 2.0;
  const auto l_shape = trace({{-1.5, -1.5, h}, {4, -1.5, h}, {4, 1.5, h}, {2, 1.5, h}, {2, 4, h}, {-1.5, 4, h}});
  expect_walls(extract_landmarks(l_shape, 0.0, kConfig), {quarter, 2 * quarter, -quarter, 2 * quarter, -quarter});
}

/// Six edges of an L-shaped desk, seen from outside.
TEST(Extract, WhatOneWalksRoundAtTheHeightOfTablesIsNoWalls) {
  const double h = 0.9;
  auto points = trace({{0, 0, h}, {3, 0, h}, {3, 1.2, h}, {1.2, 1.2, h}, {1.2, 3, h}, {0, 3, h}, {0, 0, h}});
  for (TracePoint& point : points) point.p_body = 2.0 * (point.p - Eigen::Vector3d(0.8, 0.8, h));
  for (const auto& seen : extract_landmarks(points, 0.0, kConfig).observations)
    EXPECT_NE(seen.landmark.kind, LandmarkKind::Wall);
}

TEST(Extract, ANarrowPieceOfWallIsAWall) {
  const auto found = extract_landmarks(trace({{0, 1, 1.3}, {0.5, 1, 1.2}}), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  EXPECT_EQ(found.observations[0].landmark.kind, LandmarkKind::Wall);
}

TEST(Extract, ABriefWallAfterAWall) {
  const auto found =
      extract_landmarks(trace({{0, 1.5, 1.2}, {1.5, 1.5, 1.6}, {3, 1.5, 1.2}, {3, 0.7, 1.5}}), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 2u) << found.reason;
  for (const auto& seen : found.observations) EXPECT_EQ(seen.landmark.kind, LandmarkKind::Wall);
  // Beside a screen the same is the hand on its way.
  auto path = round_trip(upright_rectangle({1.0, 1.5, 1.3}, -std::numbers::pi / 2.0, 1.4, 0.8));
  const Eigen::Vector3d end = path.back() + Eigen::Vector3d(0.0, -0.1, 0.0);
  path.push_back(end);
  path.push_back(end + Eigen::Vector3d(0.0, -0.5, 0.2));
  const auto screen = extract_landmarks(trace(path), 0.0, kConfig);
  ASSERT_EQ(screen.observations.size(), 1u);
  EXPECT_EQ(screen.observations[0].landmark.kind, LandmarkKind::Screen);
}

/// The hand is carried from one screen to the next for as long as the smaller one takes.
TEST(Extract, TwoScreensFarApartInOneGesture) {
  const auto first = round_trip(upright_rectangle({0.0, 1.5, 1.2}, -std::numbers::pi / 2.0, 0.5, 0.32));
  const auto second = round_trip(upright_rectangle({2.2, 0.6, 1.2}, std::numbers::pi, 1.3, 0.8));
  std::vector<Eigen::Vector3d> path = first;
  path.insert(path.end(), {{0.2, 1.1, 0.8}, {1.6, 0.4, 0.9}});
  path.insert(path.end(), second.begin(), second.end());
  const auto found = extract_landmarks(trace(path), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 2u) << found.reason;
  for (const auto& seen : found.observations) EXPECT_EQ(seen.landmark.kind, LandmarkKind::Screen);
  EXPECT_NEAR(found.observations[0].landmark.x[4], 0.5, 0.02);
  EXPECT_NEAR(found.observations[1].landmark.x[4], 1.3, 0.02);
}

/// Side by side on one desk they lie in one plane, and a hand that begins at the one's far side and ends at the other's
/// got as far as along a wall.
TEST(Extract, TwinScreensInOneGesture) {
  const auto drawn_from = [](double x, int corner, bool backwards) {
    auto corners = upright_rectangle({x, 1.5, 1.2}, -std::numbers::pi / 2.0, 0.57, 0.33);
    std::rotate(corners.begin(), corners.begin() + corner, corners.end());
    if (backwards) std::reverse(corners.begin() + 1, corners.end());
    return round_trip(std::move(corners));
  };
  struct Case {
    int first_corner, second_corner;
    bool first_backwards, second_backwards;
  };
  for (const Case& c : {Case{1, 2, false, true}, Case{1, 3, true, true}, Case{2, 1, false, false}}) {
    SCOPED_TRACE(testing::Message() << "from corners " << c.first_corner << " and " << c.second_corner);
    auto path = drawn_from(0.6, c.first_corner, c.first_backwards);
    const auto second = drawn_from(0.0, c.second_corner, c.second_backwards);
    path.insert(path.end(), second.begin(), second.end());
    const auto found = extract_landmarks(trace(path, {.speed_m_per_s = 0.2}), 0.0, kConfig);
    ASSERT_EQ(found.observations.size(), 2u) << found.reason;
    for (const auto& seen : found.observations) {
      EXPECT_EQ(seen.landmark.kind, LandmarkKind::Screen);
      EXPECT_NEAR(seen.landmark.x[4], 0.57, 0.03);
      EXPECT_NEAR(seen.landmark.x[5], 0.33, 0.03);
    }
  }
}

TEST(Extract, TwoSidesOfARectangleAboveTheHeightOfTablesAreNoTable) {
  // Round the corner of a room at one height; drawn all round it is a counter.
  const auto corners = level_rectangle({1.0, 0.5, 1.3}, 0.3, 1.8, 0.5);
  for (const auto& seen : extract_landmarks(trace({corners[0], corners[1], corners[2]}), 0.0, kConfig).observations)
    EXPECT_EQ(seen.landmark.kind, LandmarkKind::Wall);
  const auto counter = extract_landmarks(trace(round_trip(corners), {.body = {1.0, -1.5, 1.0}}), 0.0, kConfig);
  ASSERT_EQ(counter.observations.size(), 1u) << counter.reason;
  EXPECT_EQ(counter.observations[0].landmark.kind, LandmarkKind::Table);
}

TEST(Extract, ASmallRoundInTheAirIsNoScreen) {
  const auto found =
      extract_landmarks(trace(round_trip(upright_rectangle({0.5, 1.0, 1.4}, 0.4, 0.22, 0.18))), 0.0, kConfig);
  EXPECT_TRUE(found.observations.empty());
  EXPECT_NE(found.reason.find("too small"), std::string::npos) << found.reason;
}

TEST(Extract, SaysWhyNothingWasFound) {
  // A level surface at the height of the knees.
  const auto low = level_rectangle({0.0, 0.0, 0.1}, 0.0, 1.0, 0.6);
  EXPECT_NE(extract_landmarks(trace(round_trip(low)), 0.0, kConfig).reason.find("height"), std::string::npos);
  // A short straight line.
  EXPECT_NE(extract_landmarks(trace({{0, 1, 1}, {0.3, 1, 1}}), 0.0, kConfig).reason.find("too short"),
            std::string::npos);
  EXPECT_NE(extract_landmarks({}, 0.0, kConfig).reason.find("few"), std::string::npos);
  // Through the air.
  std::vector<Eigen::Vector3d> air;
  for (int i = 0; i <= 30; ++i)
    air.emplace_back(0.3 * std::sin(1.1 * i), 0.3 * std::cos(1.7 * i), 1.2 + 0.3 * std::sin(2.3 * i));
  const auto nothing = extract_landmarks(trace(air), 0.0, kConfig);
  EXPECT_TRUE(nothing.observations.empty());
  EXPECT_FALSE(nothing.reason.empty());
}

std::vector<TracePoint> oval(double length, double width) {
  std::vector<Eigen::Vector3d> path;
  for (int k = 0; k <= 72; ++k) {
    const double a = 2.0 * std::numbers::pi * k / 72;
    path.emplace_back(0.5 * length * std::cos(a), 1.5 + 0.5 * width * std::sin(a), 0.75);
  }
  return trace(path);
}

TEST(Extract, ARoundTableIsNoRectangle) {
  for (const auto& points : {oval(0.8, 0.8), oval(1.1, 1.1), oval(1.4, 1.4), oval(1.5, 1.1), oval(1.8, 1.0)}) {
    const auto found = extract_landmarks(points, 0.0, kConfig);
    EXPECT_TRUE(found.observations.empty());
    EXPECT_NE(found.reason.find("round"), std::string::npos) << found.reason;
  }
}

TEST(Extract, ATableWithRoundCornersIsARectangle) {
  std::vector<Eigen::Vector3d> path;
  const double half_u = 0.8, half_v = 0.4, r = 0.15;
  for (int corner = 0; corner < 4; ++corner) {
    for (int k = 0; k <= 6; ++k) {
      const double a = std::numbers::pi / 2.0 * (corner + k / 6.0);
      const double u = corner == 0 || corner == 3 ? half_u - r : r - half_u, v = corner < 2 ? half_v - r : r - half_v;
      path.emplace_back(u + r * std::cos(a), 1.5 + v + r * std::sin(a), 0.75);
    }
  }
  path.push_back(path.front());
  const auto found = extract_landmarks(trace(path), 0.0, kConfig);
  ASSERT_EQ(found.observations.size(), 1u) << found.reason;
  EXPECT_NEAR(long_side(found.observations[0].landmark), 1.6, 0.03);
  EXPECT_NEAR(short_side(found.observations[0].landmark), 0.8, 0.03);
}

TEST(Extract, MovingEverythingMovesTheTableAlong) {
  const auto corners = level_rectangle({1.2, 0.4, 0.74}, 0.2, 1.5, 0.7);
  const auto points = with_reach(trace(round_trip(corners)), {0.2, -0.9, 1.0}, 0.7);
  const Pose T_new_old = level_pose({3.0, -7.0, 0.4}, 0.5);
  auto moved = points;
  for (auto& p : moved) p.p = T_new_old * p.p, p.p_body = T_new_old * p.p_body;
  const auto a = extract_landmarks(points, 0.0, kConfig), b = extract_landmarks(moved, 0.4, kConfig);
  ASSERT_EQ(a.observations.size(), 1u);
  ASSERT_EQ(b.observations.size(), 1u);
  const auto &x = a.observations[0].landmark.x, &y = b.observations[0].landmark.x;
  EXPECT_NEAR((T_new_old * Eigen::Vector3d(x[0], x[1], x[2]) - Eigen::Vector3d(y[0], y[1], y[2])).norm(), 0.0, 2e-3);
  EXPECT_NEAR(std::max(x[4], x[5]), std::max(y[4], y[5]), 2e-3);
}

TEST(WithoutReach, KeepsEverythingOfAnEvenTrace) {
  const auto points = trace({{0, 1, 1}, {2, 1, 1}});
  const auto range = without_reach(points, kConfig);
  EXPECT_EQ(range.begin, 0u);
  EXPECT_EQ(range.end, points.size());
}

}  // namespace
}  // namespace kinemap
