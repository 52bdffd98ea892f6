// SPDX-License-Identifier: Apache-2.0
// Traces as people draw them (tests/core/landmarks/habits.hpp), many of them: what comes out must be the right object,
// with about the size that is there, and nothing else.
#include "tests/core/landmarks/habits.hpp"

#include <gtest/gtest.h>

#include "core/landmarks/extract.hpp"

namespace kinemap::test {
namespace {

constexpr std::uint32_t kTraces = 60;

struct Wearers {
  const char* name;
  double arm_m, jitter_m, noise_m, pull_rad;
  double found, error;  ///< least part of the traces that give the object; largest median error of an edge
};
constexpr Wearers kGood{"good suit", 0.010, 0.010, 0.002, 0.0, 1.0, 0.025};
constexpr Wearers kUsual{"usual suit", 0.030, 0.020, 0.004, 0.35, 0.97, 0.06};

struct Shape {
  const char* name;
  bool upright;
  int sides;
  double least_length, most_length, least_width, most_width;
};
constexpr Shape kShapes[] = {{"table, whole", false, 4, 1.0, 2.0, 0.6, 1.0},
                             {"table, two edges", false, 2, 1.0, 2.0, 0.6, 1.0},
                             {"table, three edges", false, 3, 1.0, 2.0, 0.6, 1.0},
                             {"small screen", true, 4, 0.4, 0.65, 0.3, 0.4},
                             {"big screen", true, 4, 1.0, 2.0, 0.6, 1.1}};

Habit habit(const Shape& shape, const Wearers& wearers, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  Habit h;
  h.seed = seed;
  h.upright = shape.upright;
  h.sides = shape.sides;
  h.length = uniform(shape.least_length, shape.most_length);
  h.width = uniform(shape.least_width, shape.most_width);
  h.height = shape.upright ? uniform(1.0, 1.5) : uniform(0.7, 0.78);
  h.heading = uniform(-3.0, 3.0);
  h.clockwise = seed % 2 == 0;
  h.start = seed % 3 == 0 && shape.sides == 4 ? uniform(0.2, 0.8) : 0.0;
  h.overshoot = h.start > 0.0 ? uniform(0.0, 0.12) : 0.0;
  h.speed = uniform(0.12, 0.4);
  h.rounding = uniform(0.0, 0.04);
  h.dwell_s = uniform(0.0, 0.6);
  h.idle_s = uniform(0.0, 0.5);
  h.reach_s = seed % 7 == 0 ? uniform(0.8, 1.5) : uniform(0.25, 0.8);
  h.lift_every_s = seed % 2 == 1 ? uniform(2.0, 6.0) : 0.0;
  h.arm_m = wearers.arm_m;
  h.jitter_m = wearers.jitter_m;
  h.noise_m = wearers.noise_m;
  h.pull_rad = uniform(-1.0, 1.0) * wearers.pull_rad;
  h.loss = seed % 3 == 1 ? 0.3 : 0.01;
  h.rate_hz = seed % 4 == 0 ? 60.0 : seed % 4 == 1 ? 240.0 : 120.0;
  return h;
}

class Habits : public testing::TestWithParam<Wearers> {};

TEST_P(Habits, GiveTheirObjectAndNothingElse) {
  for (const Shape& shape : kShapes) {
    std::vector<double> errors;
    std::size_t others = 0;
    for (std::uint32_t seed = 1; seed <= kTraces; ++seed) {
      const Habit h = habit(shape, GetParam(), seed);
      const auto found = extract_landmarks(trace_of(h).points, 0.0, LandmarkConfig{});
      const auto kind = shape.upright ? graph::LandmarkKind::Screen : graph::LandmarkKind::Table;
      for (const auto& seen : found.observations) {
        if (seen.landmark.kind != kind) {
          ++others;
          continue;
        }
        const auto [w, l] = std::minmax(seen.landmark.x[4], seen.landmark.x[5]);
        const auto [true_w, true_l] = std::minmax(h.length, h.width);
        errors.push_back(0.5 * (std::abs(l - true_l) / true_l + std::abs(w - true_w) / true_w));
      }
    }
    EXPECT_GE(static_cast<double>(errors.size()), GetParam().found * kTraces) << shape.name << ", " << GetParam().name;
    EXPECT_LE(static_cast<double>(others), (1.0 - GetParam().found) * kTraces) << shape.name << ", " << GetParam().name;
    EXPECT_LT(median(errors), GetParam().error * (shape.most_length < 1.0 ? 1.7 : 1.0))
        << shape.name << ", " << GetParam().name;
  }
}

INSTANTIATE_TEST_SUITE_P(Suits, Habits, testing::Values(kGood, kUsual));

TEST(Habits, ARoomsCornerAtOneHeightIsTwoWalls) {
  Habit h;
  h.sides = 2;
  h.length = 2.5, h.width = 2.0, h.height = 1.2;
  auto trace = trace_of(h);
  for (auto& point : trace.points) point.p_body = {0.0, 0.0, 0.95};  // stands inside
  const auto found = extract_landmarks(trace.points, 0.0, LandmarkConfig{});
  ASSERT_EQ(found.observations.size(), 2u) << found.reason;
  for (const auto& seen : found.observations) EXPECT_EQ(seen.landmark.kind, graph::LandmarkKind::Wall);
}

/// Two traces as one gesture: the second begins where the hand's way from the first ends.
std::vector<TracePoint> one_after_the_other(std::vector<TracePoint> first, const std::vector<TracePoint>& second,
                                            const Eigen::Vector3d& place) {
  const double begin_s = first.back().time_s + 0.1 - second.front().time_s;
  for (TracePoint point : second) {
    point.time_s += begin_s;
    point.p += place, point.p_body += place;
    first.push_back(point);
  }
  return first;
}

TEST(Habits, TwoScreensInOneGestureAreTwo) {
  Habit h;
  h.upright = true, h.height = 1.1, h.length = 0.6, h.width = 0.35;
  Habit other = h;
  other.heading = h.heading + 0.9, other.length = 0.5, other.width = 0.32, other.seed = 7;
  const auto points = one_after_the_other(trace_of(h).points, trace_of(other).points, {1.0, 0.4, 0.1});
  const auto found = extract_landmarks(points, 0.0, LandmarkConfig{});
  ASSERT_EQ(found.observations.size(), 2u) << found.reason;
  for (const auto& seen : found.observations) EXPECT_EQ(seen.landmark.kind, graph::LandmarkKind::Screen);
  EXPECT_NEAR(found.observations[0].landmark.x[4], 0.60, 0.03);
  EXPECT_NEAR(found.observations[1].landmark.x[4], 0.50, 0.03);
}

TEST(Habits, OneEdgeOfATableIsNoTable) {
  Habit h;
  h.sides = 1;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    h.seed = seed;
    h.arm_m = 0.02;
    for (const auto& seen : extract_landmarks(trace_of(h).points, 0.0, LandmarkConfig{}).observations)
      EXPECT_NE(seen.landmark.kind, graph::LandmarkKind::Table);
  }
}

}  // namespace
}  // namespace kinemap::test
