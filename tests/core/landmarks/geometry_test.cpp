// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/geometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "core/landmarks/corners.hpp"

namespace kinemap {
namespace {

TEST(FitPlane, RecoversAnyPlane) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int run = 0; run < 50; ++run) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(u(random), u(random), u(random), u(random)).normalized();
    const Eigen::Vector3d normal = q * Eigen::Vector3d::UnitZ(), origin(5.0 * u(random), 5.0 * u(random), u(random));
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 40; ++i) points.push_back(origin + q * Eigen::Vector3d(u(random), u(random), 0.0));
    const auto plane = fit_plane(points);
    ASSERT_TRUE(plane);
    EXPECT_NEAR(std::abs(plane->normal.dot(normal)), 1.0, 1e-9);
    EXPECT_NEAR(plane->offset, plane->normal.dot(origin), 1e-9);
    EXPECT_NEAR(plane->extent[2], 0.0, 1e-9);
  }
}

TEST(FitPlane, RefusesWhatLeavesADirectionOpen) {
  EXPECT_FALSE(fit_plane({}));
  EXPECT_FALSE(fit_plane(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(fit_plane(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}));
  EXPECT_FALSE(fit_plane(std::vector<Eigen::Vector3d>(10, Eigen::Vector3d(1, 2, 3))));
}

TEST(FitLine, RecoversLineAndRefusesOnePoint) {
  const std::vector<Eigen::Vector2d> points{{1, 1}, {2, 3}, {3, 5}, {4, 7}};
  const auto line = fit_line(points);
  ASSERT_TRUE(line);
  EXPECT_NEAR(std::abs(line->direction.dot(Eigen::Vector2d(1, 2).normalized())), 1.0, 1e-12);
  EXPECT_NEAR(line->distance({0, -1}), 0.0, 1e-12);
  EXPECT_FALSE(fit_line(std::vector<Eigen::Vector2d>{{1, 1}}));
  EXPECT_FALSE(fit_line(std::vector<Eigen::Vector2d>(5, {2, 2})));
}

TEST(FitLineRobust, IgnoresAThirdOfOutliers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> far(0.3, 2.0), x(0.0, 4.0);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 80; ++i) points.emplace_back(0.05 * i, 0.5);
  for (int i = 0; i < 40; ++i) points.emplace_back(x(random), 0.5 + far(random));
  const auto line = fit_line_robust(points, 0.05);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->distance({0.0, 0.5}), 0.0, 1e-3);
  EXPECT_NEAR(line->distance({4.0, 0.5}), 0.0, 1e-3);
}

TEST(Winding, CountsTurnsWithTheirSign) {
  std::vector<Eigen::Vector2d> circle;
  for (int i = 0; i <= 40; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 40;
    circle.emplace_back(3.0 + std::cos(a), std::sin(a));
  }
  EXPECT_NEAR(winding(circle, {3.0, 0.0}), 2.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(winding(circle, {9.0, 0.0}), 0.0, 1e-9);
  std::reverse(circle.begin(), circle.end());
  EXPECT_NEAR(winding(circle, {3.0, 0.0}), -2.0 * std::numbers::pi, 1e-9);
}

TEST(Corners, OneAtTheBendOfAnL) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(0.02 * i, 0.0);
  for (int i = 0; i < 50; ++i) points.emplace_back(1.0, 0.02 * i);
  const auto corners = find_corners(points, 0.18, 0.8);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_NEAR((points[corners[0]] - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 0.03);
  EXPECT_NEAR(corner_angles(points, 0.18)[corners[0]], std::numbers::pi / 2.0, 0.1);
}

TEST(Corners, NoneOnAStraightLineOrAWideArc) {
  std::vector<Eigen::Vector2d> line, arc;
  for (int i = 0; i < 100; ++i) line.emplace_back(0.02 * i, 0.0);
  for (int i = 0; i < 100; ++i) arc.emplace_back(std::cos(0.02 * i), std::sin(0.02 * i));
  EXPECT_TRUE(find_corners(line, 0.18, 0.8).empty());
  EXPECT_TRUE(find_corners(arc, 0.18, 0.8).empty());
  EXPECT_TRUE(find_corners({}, 0.18, 0.8).empty());
}

TEST(FourthCorner, MirrorsThroughTheMiddleOfTheDiagonal) {
  const std::vector<Eigen::Vector2d> l{{0, 2}, {0, 1}, {0, 0}, {1, 0}, {3, 0}};
  const auto [a, b] = farthest_pair(l);
  EXPECT_EQ(l[a], Eigen::Vector2d(0, 2));
  EXPECT_EQ(l[b], Eigen::Vector2d(3, 0));
  EXPECT_EQ(fourth_corner({0, 0}, l[a], l[b]), Eigen::Vector2d(3, 2));
}

TEST(Median, OfNoneOneAndMany) {
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(median({4.0}), 4.0);
  EXPECT_EQ(median({9.0, 1.0, 5.0}), 5.0);
}

}  // namespace
}  // namespace kinemap
