// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

using Eigen::Vector3d;

TEST(KeyPoses, FirstFrameAlways) {
  const Puppet puppet;
  std::vector<Event> events;
  Tracker tracker{TrackerConfig{}};
  tracker.step(puppet.report(puppet.pose(standing()), 0.0), events);
  ASSERT_EQ(events.size(), 1u);
  const auto& key = std::get<KeyPose>(events[0]);
  EXPECT_EQ(key.id, 0u);
  EXPECT_EQ(key.path_m, 0.0);
  EXPECT_FALSE(key.discontinuity);
  tracker.finish(events);
  EXPECT_EQ(events.size(), 1u) << "the only frame is a key pose already";
}

TEST(KeyPoses, WalkingGivesOneEachTwentyCentimetresAtAnyRate) {
  for (const double rate : {60.0, 120.0, 240.0}) {
    for (const double loss : {0.0, 0.5}) {
      const Puppet puppet;
      const auto frames = perform(puppet, {{10.0, [](double t) { return walking(t, 1.2); }}}, {rate, loss, 7});
      const Outcome outcome = track(frames);
      // 12 m / 0.2 m; each is late by up to one frame, i.e. by 2 cm at 60 Hz, twice that and more with losses.
      EXPECT_GT(outcome.key_poses.size(), loss > 0 && rate < 100 ? 45u : 53u) << rate << " " << loss;
      EXPECT_LE(outcome.key_poses.size(), 62u);
      EXPECT_NEAR(outcome.stats.path_m, 12.0, 0.2) << rate << " " << loss;
      double path = 0.0;
      for (std::size_t i = 1; i < outcome.key_poses.size(); ++i) {
        const KeyPose& key = outcome.key_poses[i];
        const KeyPose& before = outcome.key_poses[i - 1];
        EXPECT_EQ(key.id, before.id + 1);
        EXPECT_GT(key.time_s, before.time_s);
        EXPECT_GE(key.path_m + 1e-9, (key.T_odom_pelvis.p - before.T_odom_pelvis.p).head<2>().norm());
        path += key.path_m;
      }
      EXPECT_NEAR(path, outcome.stats.path_m, 1e-9);
    }
  }
}

TEST(KeyPoses, TurningOnTheSpotGivesOneEachTenDegrees) {
  const Puppet puppet;
  const std::vector<Act> acts{{9.0, [](double t) {
                                 Figure f = standing();
                                 f.heading = std::numbers::pi + 40 * kDegree * t;  // passes ±180°
                                 return f;
                               }}};
  const Outcome outcome = track(perform(puppet, acts));
  EXPECT_NEAR(static_cast<double>(outcome.key_poses.size()), 36, 2);
  double turn = 0.0;
  for (const KeyPose& key : outcome.key_poses) turn += key.turn_rad;
  EXPECT_NEAR(turn / kDegree, 360, 2);
}

TEST(KeyPoses, StandingStillGivesOneEachTenSeconds) {
  const Puppet puppet;
  const Outcome outcome = track(perform(puppet, {{31.0, [](double) { return standing(); }}}, {60.0, 0.3, 3}));
  EXPECT_EQ(outcome.key_poses.size(), 5u) << "0, 10, 20, 30 s and the end";
}

// The suit's noise is white in every frame: the sums must not grow with the number of frames.
TEST(KeyPoses, NoiseOfAStandingSuitIsNoPath) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.003);
  const Puppet puppet;
  auto frames = perform(puppet, {{20.0, [](double) { return standing(); }}}, {240.0});
  for (SuitFrame& frame : frames) {
    const Pose shake = level_pose({noise(random), noise(random), 0}, noise(random));
    for (Pose& segment : frame.segments) segment = shake * segment;
  }
  const Outcome outcome = track(frames);
  EXPECT_LT(outcome.stats.path_m, 0.3);
  double turn = 0.0;
  for (const KeyPose& key : outcome.key_poses) turn += key.turn_rad;
  EXPECT_LT(turn / kDegree, 15);
}

TEST(KeyPoses, DiscontinuityIsMarkedAndItsJumpIsNoPath) {
  const Puppet puppet;
  auto frames = perform(puppet, {{4.0, [](double t) { return walking(t, 1.0); }}});
  const std::size_t at = frames.size() / 2;
  const Pose jump = level_pose({5, -3, 0}, 2.0);
  for (std::size_t i = at; i < frames.size(); ++i) {
    for (Pose& segment : frames[i].segments) segment = jump * segment;
  }
  frames[at].discontinuity = true;
  const Outcome outcome = track(frames);
  std::size_t marked = 0;
  for (std::size_t k = 0; k < outcome.key_poses.size(); ++k) {
    const KeyPose& key = outcome.key_poses[k];
    if (!key.discontinuity) continue;
    ++marked;
    ASSERT_GT(k, 0u);
    EXPECT_EQ(outcome.key_poses[k - 1].time_s, frames[at - 1].time_s) << "the break is no longer than it was";
    EXPECT_EQ(key.time_s, frames[at].time_s);
    EXPECT_EQ(key.path_m, 0.0);
    EXPECT_EQ(key.turn_rad, 0.0);
  }
  EXPECT_EQ(marked, 1u);
  EXPECT_NEAR(outcome.stats.path_m, 4.0, 0.15);
}

TEST(Stance, IsUnderTheAnkleOfAFootAtRestWhileWalking) {
  for (const double rate : {60.0, 240.0}) {
    const Puppet puppet;
    const auto frames = perform(puppet, {{10.0, [](double t) { return walking(t, 1.2); }}}, {rate, 0.3, 11});
    const Outcome outcome = track(frames);
    std::size_t with = 0;
    double sum = 0.0;
    for (const KeyPose& key : outcome.key_poses) {
      if (!key.p_pelvis_stance) continue;
      ++with;
      const Vector3d p = key.T_odom_pelvis * *key.p_pelvis_stance;
      EXPECT_NEAR(p.z(), 0.0, 0.03) << "the sole is on the floor at " << key.time_s;  // less than a foot rolling off
      sum += std::abs(p.z());
    }
    EXPECT_GT(with, outcome.key_poses.size() * 7 / 10);
    EXPECT_LT(sum / static_cast<double>(with), 0.005);
  }
}

TEST(Stance, IsOnTheFloorForEveryStature) {
  for (const double stature : {1.55, 1.75, 1.95}) {
    const Puppet puppet(stature);
    const Outcome outcome = track(perform(puppet, {{1.0, [](double) { return standing(); }}}));
    ASSERT_TRUE(outcome.key_poses.back().p_pelvis_stance);
    const Vector3d p = outcome.key_poses.back().T_odom_pelvis * *outcome.key_poses.back().p_pelvis_stance;
    EXPECT_NEAR(p.z(), 0.018 * stature / 1.75 - 0.02, 1e-3) << "the sole is taken 2 cm under the ball";
    EXPECT_NEAR(std::abs(p.y()), 0.09 * stature / 1.75, 0.01);
  }
}

TEST(Stance, AbsentInTheAirAndWhenSitting) {
  const Puppet puppet;
  const Outcome sat = track(perform(puppet, between_standing(6.0, [&](double) { return sitting(puppet, 0.45); })));
  for (const KeyPose& key : sat.key_poses) {
    if (key.time_s > 3.0 && key.time_s < 7.9) {
      EXPECT_FALSE(key.p_pelvis_stance) << key.time_s;
    }
  }
  auto frames = perform(puppet, {{2.0, [](double) { return standing(); }}});
  for (SuitFrame& frame : frames) {  // falling at 1 m/s and more
    for (Pose& segment : frame.segments)
      segment.p += Vector3d(0.5 * frame.time_s, 0, -0.5 * 9.8 * frame.time_s * frame.time_s);
  }
  const Outcome fell = track(frames);
  EXPECT_FALSE(fell.key_poses.back().p_pelvis_stance);
}

// One foot on a step of a stair: the lower one is named.
TEST(Stance, IsTheLowerFoot) {
  const Puppet puppet;
  const std::vector<Act> acts{{1.0, [](double) {
                                 Figure f = standing();
                                 f.ankle[0] = {0.25, 0.09, 0.17};
                                 return f;
                               }}};
  const Outcome outcome = track(perform(puppet, acts));
  ASSERT_TRUE(outcome.key_poses.back().p_pelvis_stance);
  EXPECT_LT(outcome.key_poses.back().p_pelvis_stance->y(), 0.0) << "the right foot stands on the floor";
}

}  // namespace
}  // namespace kinemap::test
