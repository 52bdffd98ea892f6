// SPDX-License-Identifier: Apache-2.0
#include "core/reach.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

constexpr double kFrame = 1.0 / 120.0;

Eigen::Quaterniond yaw(double angle) { return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())); }

TEST(Reach, WhatPeopleDoIsWithinReach) {
  const Pose here{{3, -1, 0.95}, yaw(0.4)};
  const auto moved = [&](double forward, double down, double turn) {
    return Pose{here.p + Eigen::Vector3d(forward, 0, -down), yaw(turn) * here.q};
  };
  EXPECT_TRUE(within_reach(here, moved(7.0 * kFrame, 0.0, 0.0), kFrame)) << "a sprint";
  EXPECT_TRUE(within_reach(here, moved(2.0 * kFrame, 4.5 * kFrame, 0.0), kFrame)) << "a jump from a metre";
  EXPECT_TRUE(within_reach(here, moved(0.0, 0.0, 12.0 * kFrame), kFrame)) << "a spin, twice a second";
  EXPECT_TRUE(within_reach(here, moved(3.0, 0.0, 3.0), 0.5)) << "a run, half a second of it lost";
  EXPECT_TRUE(within_reach(here, moved(60.0, 0.0, 3.0), 60.0)) << "a minute unseen";
}

TEST(Reach, WhatOnlyAResetDoesIsNot) {
  const Pose here{{3, -1, 0.95}, yaw(0.4)};
  EXPECT_FALSE(within_reach(here, {{0, 0, 0.95}, yaw(0.4)}, kFrame)) << "back to the origin";
  EXPECT_FALSE(within_reach(here, {here.p, yaw(0.9)}, kFrame)) << "another heading";
  EXPECT_FALSE(within_reach(here, {{0, 0, 0.95}, yaw(0.4)}, 0.2)) << "a burst of loss does not hide it";
}

TEST(Reach, WhoStayedLeansAsAfterwardsAndFacesAsBefore) {
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.2, 0.9, 0.0).normalized()));
  for (const double turn : {-3.0, -0.5, 0.0, 1.7, 3.1}) {
    const Pose before{{3, -1, 0.95}, yaw(0.4)};
    const Pose after{{0.2, 0.1, 0.97}, yaw(turn) * lean * before.q};
    const Pose there = stayed(before, after);
    EXPECT_EQ(there.p, before.p);
    EXPECT_NEAR((there.q * Eigen::Vector3d::UnitX() - lean * before.q * Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-9)
        << turn;
    EXPECT_NEAR(
        (there.q.conjugate() * Eigen::Vector3d::UnitZ() - after.q.conjugate() * Eigen::Vector3d::UnitZ()).norm(), 0.0,
        1e-9)
        << "gravity, in the body";
  }
}

}  // namespace
}  // namespace kinemap
