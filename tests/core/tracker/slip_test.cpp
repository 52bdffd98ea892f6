// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/slip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace kinemap::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRate = 120.0;

/// A pelvis over two feet, and where the suit thinks that all of it is.
struct Stream {
  std::function<Pose(double)> pelvis = [](double) { return level_pose({0.0, 0.0, 0.95}, 0.0); };
  std::function<Pose(std::size_t side, double t)> foot = [](std::size_t side, double) {
    return level_pose({0.0, side == 0 ? 0.1 : -0.1, 0.08}, 0.0);
  };
  std::function<Pose(double t)> slip = [](double) { return Pose{}; };  ///< T_odom_true
  bool held = false;                                                   ///< the suit does not let feet slip

  [[nodiscard]] SuitFrame at(double t) const {
    SuitFrame frame;
    frame.time_s = t;
    frame[Segment::Pelvis] = slip(t) * pelvis(t);
    for (std::size_t i = 0; i < 2; ++i) {
      const Pose ankle = held ? foot(i, t) : slip(t) * foot(i, t);
      frame[kFoot[i]] = ankle;
      frame[kToe[i]] = ankle * level_pose({0.15, 0.0, -0.06}, 0.0);
    }
    return frame;
  }
};

/// What the feet say of the time from `begin_s` to `end_s`; the stream begins at 0.
std::optional<Slip> heard(const Stream& stream, double begin_s, double end_s, double rate = kRate) {
  SlipFold fold{{}};
  std::optional<Slip> slip;
  bool begun = false;
  for (int i = 0; i <= end_s * rate; ++i) {
    const double t = i / rate;
    if (!begun && t >= begin_s) fold.begin(), begun = true;
    const SuitFrame frame = stream.at(t);
    slip = fold.step(frame, soles_of(frame, 0.02));
  }
  return slip;
}

/// Stands for 6 s, then walks along x at 1 m/s, each foot 60 % of the time on the floor.
Stream walk() {
  Stream stream;
  stream.pelvis = [](double t) { return level_pose({std::max(0.0, t - 6.0), 0.0, 0.95}, 0.0); };
  stream.foot = [](std::size_t foot, double t) {
    const double steps = std::max(0.0, t - 6.0) / 1.2 + (foot == 0 ? 0.0 : 0.5), n = std::floor(steps),
                 phase = steps - n;
    const double swing = std::clamp((phase - 0.6) / 0.4, 0.0, 1.0), ahead = 1.2 * (0.5 - 0.5 * std::cos(swing * M_PI));
    return level_pose({1.2 * (n - (foot == 0 ? 0.0 : 0.5)) + 0.3 + ahead, foot == 0 ? 0.1 : -0.1,
                       0.08 + 0.15 * std::sin(swing * M_PI)},
                      0.0);
  };
  return stream;
}

TEST(Slip, StandingFeetTellHowFarTheSuitTurnsByItself) {
  for (const double rate : {60.0, 120.0, 240.0}) {
    Stream stream;
    stream.slip = [](double t) { return level_pose({0.0, 0.0, 0.0}, kDegree * t); };
    const auto slip = heard(stream, 10.0, 20.0, rate);
    ASSERT_TRUE(slip) << rate;
    EXPECT_NEAR(slip->turn_rad, -10.0 * kDegree, 0.1 * kDegree) << rate;
    EXPECT_NEAR(slip->stood_s, 10.0, 0.1) << rate;
    EXPECT_NEAR(slip->apart_rad, 0.0, 1e-9) << rate;
    EXPECT_NEAR(slip->way_m.norm(), 0.0, 0.01) << rate;
  }
}

TEST(Slip, StandingFeetTellHowFarTheSuitSlidesByItself) {
  Stream stream;
  stream.slip = [](double t) { return level_pose({0.02 * t, -0.01 * t, 0.0}, 0.0); };
  const auto slip = heard(stream, 10.0, 20.0);
  ASSERT_TRUE(slip);
  EXPECT_NEAR(slip->way_m.x(), -0.2, 0.005);
  EXPECT_NEAR(slip->way_m.y(), 0.1, 0.005);
  EXPECT_NEAR(slip->turn_rad, 0.0, 1e-9);
}

TEST(Slip, WhatTheBodyDoesOverItsFeetIsNoSlip) {
  Stream stream;
  stream.pelvis = [](double t) { return level_pose({0.1 * std::sin(t), 0.05 * std::cos(t), 0.95}, 0.3 * std::sin(t)); };
  stream.slip = [](double t) { return level_pose({0.0, 0.0, 0.0}, kDegree * t); };
  const auto slip = heard(stream, 10.0, 20.0);
  ASSERT_TRUE(slip);
  EXPECT_NEAR(slip->turn_rad, -10.0 * kDegree, 0.1 * kDegree);
}

TEST(Slip, OnTheWayEachFootTellsWhileItStands) {
  constexpr double kTurn = 0.1 * kDegree;  // a second, about the origin: far from there the feet slide as well
  Stream stream = walk();
  stream.slip = [](double t) { return level_pose({0.02 * t, 0.0, 0.0}, kTurn * t); };
  const auto slip = heard(stream, 12.0, 24.0);
  ASSERT_TRUE(slip);
  EXPECT_GT(slip->stood_s, 4.0);
  EXPECT_NEAR(slip->turn_rad, -kTurn * slip->stood_s, 0.02 * kDegree);
  EXPECT_LT(slip->way_m.x(), -0.02 * 4.0);
}

TEST(Slip, ASuitThatHoldsStandingFeetIsNotHeard) {
  for (Stream stream : {Stream{}, walk()}) {
    stream.held = true;
    stream.slip = [](double t) { return level_pose({0.01 * t, 0.0, 0.0}, kDegree * t); };
    EXPECT_FALSE(heard(stream, 10.0, 30.0));
  }
}

TEST(Slip, ASuitThatDoesNotSlipIsNotHeard) { EXPECT_FALSE(heard(walk(), 10.0, 30.0)); }

TEST(Slip, AFootThatTurnsIsNotHeard) {
  Stream stream;
  stream.slip = [](double t) { return level_pose({0.0, 0.0, 0.0}, kDegree * t); };
  stream.foot = [](std::size_t foot,
                   double t) {  // from 10 s on both feet step round to another heading, and stay there
    const double heading = std::clamp(t - 10.0, 0.0, 1.0) * 60.0 * kDegree;
    return level_pose({0.0, foot == 0 ? 0.1 : -0.1, 0.08}, heading);
  };
  const auto slip = heard(stream, 10.0, 20.0);
  ASSERT_TRUE(slip);
  EXPECT_LT(slip->stood_s, 9.0);
  EXPECT_NEAR(slip->turn_rad, -kDegree * slip->stood_s, 1.0 * kDegree);
}

TEST(Slip, OneFootThatTurnsIsTold) {
  Stream stream;
  stream.slip = [](double t) { return level_pose({0.0, 0.0, 0.0}, kDegree * t); };
  stream.foot = [](std::size_t foot, double t) {
    return level_pose({0.0, foot == 0 ? 0.1 : -0.1, 0.08}, foot == 0 ? 0.0 : 3.0 * kDegree * std::max(0.0, t - 10.0));
  };
  const auto slip = heard(stream, 10.0, 12.0);
  ASSERT_TRUE(slip);
  EXPECT_NEAR(slip->apart_rad, 6.0 * kDegree, 0.3 * kDegree);
}

TEST(Slip, ABreakIsNoSlip) {
  Stream stream;
  stream.slip = [](double t) { return level_pose({t > 15.0 ? 3.0 : 0.0, 0.0, 0.0}, kDegree * t); };
  SlipFold fold{{}};
  std::optional<Slip> slip;
  for (int i = 0; i <= 20 * kRate; ++i) {
    const double t = i / kRate;
    if (t > 15.0 && (i - 1) / kRate <= 15.0) fold.reset();
    const SuitFrame frame = stream.at(t);
    slip = fold.step(frame, soles_of(frame, 0.02));
  }
  ASSERT_TRUE(slip);
  EXPECT_LT(slip->way_m.norm(), 0.1);
}

}  // namespace
}  // namespace kinemap::test
