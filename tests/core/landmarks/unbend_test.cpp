// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/unbend.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/landmarks/extract.hpp"
#include "tests/core/landmarks/contours.hpp"

namespace kinemap {
namespace {

/// A table top of 1.6 m × 0.8 m that somebody walks round, always 0.4 m from the edge.
std::vector<TracePoint> round_table() {
  const std::vector<Eigen::Vector3d> corners{
      {0.0, 0.0, 0.75}, {1.6, 0.0, 0.75}, {1.6, 0.8, 0.75}, {0.0, 0.8, 0.75}, {0.0, 0.0, 0.75}};
  auto points = test::trace(corners, {.speed_m_per_s = 0.3, .noise_m = 0.002});
  const Eigen::Vector3d middle(0.8, 0.4, 0.75);
  for (auto& point : points) point.p_body = point.p + 0.4 * (point.p - middle).normalized();
  return points;
}

/// A screen of 1.4 m × 0.8 m, drawn by somebody who walks to and fro 0.5 m before it.
std::vector<TracePoint> along_screen() {
  auto corners = test::upright_rectangle({1.0, 1.5, 1.3}, -std::numbers::pi / 2.0, 1.4, 0.8);
  corners.push_back(corners.front());
  auto points = test::trace(corners, {.speed_m_per_s = 0.3, .noise_m = 0.002});
  for (auto& point : points) point.p_body = {point.p.x(), point.p.y() - 0.5, 1.0};
  return points;
}

TEST(Unbend, TurningBackAndForthChangesNothing) {
  const auto points = round_table();
  const auto again = unbent(unbent(points, 0.03), -0.03);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((again[i].p - points[i].p).norm(), 1e-9);
    EXPECT_LT((again[i].p_body - points[i].p_body).norm(), 1e-9);
  }
}

TEST(Unbend, AContourDrawnWhileTheHeadingTurnedIsARectangleOfTheRightSize) {
  for (const double rate : {-0.035, 0.02, 0.035}) {
    const auto bent = unbent(round_table(), -rate);
    EXPECT_GT((bent.front().p - bent.back().p).norm(), 0.2);  // it does not close
    const auto found = extract_landmarks(bent, 0.0, {});
    ASSERT_EQ(found.observations.size(), 1U) << rate << found.reason;
    const auto& table = found.observations[0].landmark;
    ASSERT_EQ(table.kind, graph::LandmarkKind::Table);
    EXPECT_NEAR(std::max(table.x[4], table.x[5]), 1.6, 0.03) << rate;
    EXPECT_NEAR(std::min(table.x[4], table.x[5]), 0.8, 0.03) << rate;
  }
}

TEST(Unbend, AScreenDrawnWhileTheHeadingTurnedIsNoWallAndNoMystery) {
  for (const double rate : {-0.04, 0.03, 0.04}) {
    const auto bent = unbent(along_screen(), -rate);
    const auto found = extract_landmarks(bent, 0.0, {});
    ASSERT_EQ(found.observations.size(), 1U) << rate << found.reason;
    const auto& screen = found.observations[0].landmark;
    ASSERT_EQ(screen.kind, graph::LandmarkKind::Screen) << rate;
    EXPECT_NEAR(screen.x[4], 1.4, 0.03) << rate;
    EXPECT_NEAR(screen.x[5], 0.8, 0.03) << rate;
    EXPECT_TRUE(found.observations[0].closed);
  }
}

TEST(Unbend, TwoScreensInOneGestureWhileTheHeadingTurned) {
  for (const double rate : {-0.03, 0.03}) {
    auto points = along_screen();
    const double begin_s = points.back().time_s + 1.0;
    for (const TracePoint& p : along_screen())
      points.push_back({p.time_s + begin_s, p.p + Eigen::Vector3d(2.5, 0.0, 0.1), p.p_body});
    const auto found = extract_landmarks(unbent(points, -rate), 0.0, {});
    ASSERT_EQ(found.observations.size(), 2U) << rate << found.reason;
    for (const auto& seen : found.observations) {
      EXPECT_EQ(seen.landmark.kind, graph::LandmarkKind::Screen) << rate;
      EXPECT_NEAR(seen.landmark.x[4], 1.4, 0.04) << rate;
      EXPECT_NEAR(seen.landmark.x[5], 0.8, 0.04) << rate;
    }
  }
}

TEST(Unbend, WavingAlongTwoWallsIsNoScreen) {
  // Two walls that meet at 150°, as a bent wall would look, and a hand that goes up and down on them.
  std::vector<Eigen::Vector3d> path;
  for (int k = 0; k <= 8; ++k) {
    const double x = 0.5 * k, y = x < 2.0 ? 1.5 : 1.5 - std::tan(std::numbers::pi / 6.0) * (x - 2.0);
    path.emplace_back(x, y, k % 2 == 0 ? 1.1 : 1.5);
  }
  const auto found = extract_landmarks(test::trace(path, {.noise_m = 0.002}), 0.0, {});
  EXPECT_EQ(found.observations.size(), 2U) << found.reason;
  for (const auto& seen : found.observations) EXPECT_EQ(seen.landmark.kind, graph::LandmarkKind::Wall);
}

TEST(Unbend, WhatIsStraightIsLeftAlone) {
  const auto misfit = [](std::span<const TracePoint>) { return 1e-4; };
  EXPECT_EQ(heading_rate(round_table(), misfit), 0.0);
  // A little better is not enough: the prior and the odds speak for a heading that holds.
  const auto points = round_table();
  const auto slightly = [&](std::span<const TracePoint> tried) {
    return (tried.front().p - points.front().p).norm() > 1e-9 ? 0.9e-4 : 1e-4;
  };
  EXPECT_EQ(heading_rate(points, slightly), 0.0);
}

TEST(Unbend, ARateWithWhichAContourIsFoundBeatsNone) {
  const auto points = round_table();
  const auto only_turned = [&](std::span<const TracePoint> tried) {
    return (tried.front().p - points.front().p).norm() > 1e-9 ? 1e-4 : HUGE_VAL;
  };
  EXPECT_NE(heading_rate(points, only_turned), 0.0);
}

}  // namespace
}  // namespace kinemap
