// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

using Eigen::Vector3d;

struct Row {
  const char* name;
  std::function<Figure(const Puppet&, double)> figure;
  bool moves = false;
};

std::vector<Act> acts_of(const Row& row, const Puppet& puppet) {
  if (row.moves) return between_standing(8.0, [&](double t) { return row.figure(puppet, t); });
  return between_standing(8.0, [still = row.figure(puppet, 0.0)](double) { return still; });
}

std::string lines_of(const std::vector<Sitting>& sittings) {
  std::string text;
  for (const Sitting& s : sittings) text += std::to_string(s.begin_s) + "–" + std::to_string(s.end_s) + " s; ";
  return text;
}

const std::vector<Row>& seats() {
  static const std::vector<Row> rows{
      {"chair 0.45", [](const Puppet& p, double) { return sitting(p, 0.45); }},
      {"low chair 0.38", [](const Puppet& p, double) { return sitting(p, 0.38); }},
      {"high chair 0.50", [](const Puppet& p, double) { return sitting(p, 0.50); }},
      {"sofa", [](const Puppet& p, double) { return lounging(p, 0.40); }},
      {"one leg crossed", [](const Puppet& p, double) { return sitting_cross_legged(p, 0.45); }},
      {"chest twisted", [](const Puppet& p, double) { return sitting_twisted(p, 0.45); }},
      {"leaning forward half of the time",
       [](const Puppet& p, double t) { return t < 4 ? sitting(p, 0.45) : sitting_leaning(p, 0.45); }, true},
  };
  return rows;
}

const std::vector<Row>& no_seats() {
  static const std::vector<Row> rows{
      {"standing", [](const Puppet&, double) { return standing(); }},
      {"half squat", [](const Puppet& p, double) { return squatting(p, 0.60); }},
      {"squat", [](const Puppet& p, double) { return squatting(p, 0.48); }},
      {"deep squat", [](const Puppet& p, double) { return squatting(p, 0.36); }},
      {"squat on toes", [](const Puppet& p, double) { return squatting_on_toes(p); }},
      {"kneeling on the heels", [](const Puppet&, double) { return kneeling_on_heels(); }},
      {"kneeling upright", [](const Puppet&, double) { return kneeling_upright(); }},
      {"kneeling on one knee", [](const Puppet&, double) { return kneeling_on_one_knee(); }},
      {"stooping", [](const Puppet& p, double) { return stooping(p); }},
      {"perching, thighs at 35°", [](const Puppet& p, double) { return perching(p, 35 * kDegree); }},
      {"perching, thighs at 50°", [](const Puppet& p, double) { return perching(p, 50 * kDegree); }},
      {"lying on the floor", [](const Puppet&, double) { return lying(0.0); }},
      {"lying on a bed", [](const Puppet&, double) { return lying(0.45); }},
      {"sitting on the floor", [](const Puppet&, double) { return sitting_on_floor(); }},
      {"leaning on a wall", [](const Puppet&, double) { return leaning_on_wall(); }},
      {"jumping", [](const Puppet& p, double t) { return jumping(p, t); }, true},
      {"walking", [](const Puppet&, double t) { return walking(t, 1.2); }, true},
  };
  return rows;
}

TEST(Sitting, EverySeatIsSeenOnceForEveryWearerAndStream) {
  for (const Row& row : seats()) {
    for (const Case& c : cases()) {
      const Puppet puppet(c.stature_m, c.errors);
      const auto acts = acts_of(row, puppet);
      const Outcome outcome = track(perform(puppet, acts, c.sampling));
      EXPECT_EQ(outcome.sittings.size(), 1u) << row.name << ", " << describe(c) << ": " << lines_of(outcome.sittings);
    }
  }
}

TEST(Sitting, OtherPosturesAreNoSeats) {
  for (const Row& row : no_seats()) {
    for (const Case& c : cases()) {
      const Puppet puppet(c.stature_m, c.errors);
      const auto acts = acts_of(row, puppet);
      const Outcome outcome = track(perform(puppet, acts, c.sampling));
      EXPECT_TRUE(outcome.sittings.empty()) << row.name << ", " << describe(c) << ": " << lines_of(outcome.sittings);
    }
  }
}

TEST(Sitting, WhoSitsOverTheFeetIsSeenAfterAWhile) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto acts = between_standing(25.0, [&](double) { return sitting_leaning(puppet, 0.45); });
    const auto frames = perform(puppet, acts, c.sampling);
    EXPECT_EQ(track(frames).sittings.size(), 1u) << describe(c);
    TrackerConfig config;
    config.sitting.surely_still_s = 1000.0;
    EXPECT_TRUE(track(frames, config).sittings.empty()) << describe(c) << ": nothing but the time tells";
  }
}

// Seat where the hips were, facing where the pelvis faced, at the seat's height: exactly without suit errors.
TEST(Sitting, SeatPoseIsThatOfTheHips) {
  for (const double stature : {1.55, 1.75, 1.95}) {
    const Puppet puppet(stature);
    constexpr double kHeading = 0.7;
    const auto acts = between_standing(8.0, [&](double) {
      Figure f = sitting_twisted(puppet, 0.45);
      f.heading = kHeading;
      f.hips.head<2>() = Eigen::Vector2d(0.1, -0.2);
      return f;
    });
    const Outcome outcome = track(perform(puppet, acts));
    ASSERT_EQ(outcome.sittings.size(), 1u);
    const Sitting& s = outcome.sittings[0];
    const Pose T_odom_seat = outcome.key(s.key_pose) * s.T_key_seat;
    const Vector3d expected = Vector3d(0.1, -0.2, 0.45) - 0.07 * Vector3d(std::cos(kHeading), std::sin(kHeading), 0);
    EXPECT_NEAR((T_odom_seat.p - expected).norm(), 0.0, 0.005);
    EXPECT_NEAR(wrap_angle(heading_of(T_odom_seat.q) - kHeading), 0.0, 0.01);
    EXPECT_NEAR((T_odom_seat.q * Vector3d::UnitZ()).z(), 1.0, 1e-9) << "the seat is level";
    EXPECT_NEAR(s.height_m, 0.45, 0.005);
    EXPECT_LT(s.spread_m, 0.02);
    EXPECT_NEAR(s.begin_s, 2.5, 0.5);
    EXPECT_NEAR(s.end_s, 10.3, 0.5);
  }
}

// The leaner's heights come from wrong leg lengths (3 %) and tilted segments (2°): 0.54 m · 3 % + 0.85 m · sin 2° at
// the very worst.
TEST(Sitting, SeatHeightToleratesAWrongBody) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto acts = between_standing(8.0, [&](double) { return sitting(puppet, 0.45); });
    const Outcome outcome = track(perform(puppet, acts, c.sampling));
    ASSERT_EQ(outcome.sittings.size(), 1u) << describe(c);
    EXPECT_NEAR(outcome.sittings[0].height_m, 0.45, 0.045) << describe(c);
  }
}

// While a bout lasts the suit's heading may be drawn away by the desk. The seat refers to a key pose in the middle of
// the bout.
TEST(Sitting, DriftDuringTheBoutCancels) {
  const Puppet puppet;
  auto frames = perform(puppet, between_standing(20.0, [&](double) { return sitting(puppet, 0.45); }));
  constexpr double kRate = 1.0 * kDegree;  // per second
  for (SuitFrame& frame : frames) {
    const Pose drift = level_pose(Vector3d::Zero(), kRate * frame.time_s);
    for (Pose& segment : frame.segments) segment = drift * segment;
  }
  const Outcome outcome = track(frames);
  ASSERT_EQ(outcome.sittings.size(), 1u);
  const Sitting& s = outcome.sittings[0];
  // Relative to that key pose's own pelvis the drift is gone: the seat faces as the pelvis does.
  EXPECT_NEAR(heading_of(s.T_key_seat.q) * 180 / std::numbers::pi, 0.0, 1.0);
  EXPECT_NEAR(outcome.key_poses[s.key_pose].time_s, 12.0, 2.0);
}

// Thigh inclination moving to and fro inside the hysteresis band is one bout, not many.
TEST(Sitting, HysteresisKeepsABoutTogether) {
  const Puppet puppet;
  const auto acts = between_standing(12.0, [&](double t) {
    // Sliding forward to the edge of the seat and back: thighs from 0.25 to 0.58 of upright.
    Figure f = sitting(puppet, 0.50);
    const double x = t < 4 ? 0.0 : 0.5 - 0.5 * std::cos(2 * std::numbers::pi * 0.25 * (t - 4));
    f.hips.z() += 0.11 * x;
    return f;
  });
  TrackerConfig config;
  EXPECT_EQ(track(perform(puppet, acts), config).sittings.size(), 1u);
  config.sitting.thigh_off = config.sitting.thigh_on;
  config.sitting.thigh_low_on = config.sitting.thigh_on;
  EXPECT_GT(track(perform(puppet, acts), config).sittings.size(), 1u) << "the test must cross the first threshold";
}

TEST(Sitting, AShortTouchdownIsDropped) {
  const Puppet puppet;
  const Outcome outcome = track(perform(puppet, between_standing(1.3, [&](double) { return sitting(puppet, 0.45); })));
  EXPECT_TRUE(outcome.sittings.empty());
}

TEST(Sitting, RollingToAnotherPlaceIsASecondSeat) {
  const Puppet puppet;
  const auto acts = between_standing(16.0, [&](double t) {
    Figure f = sitting(puppet, 0.45);
    f.hips.x() = std::clamp((t - 7.0) * 0.5, 0.0, 1.0);
    return f;
  });
  const Outcome outcome = track(perform(puppet, acts));
  ASSERT_EQ(outcome.sittings.size(), 2u);
  const Vector3d first = (outcome.key(outcome.sittings[0].key_pose) * outcome.sittings[0].T_key_seat).p;
  const Vector3d second = (outcome.key(outcome.sittings[1].key_pose) * outcome.sittings[1].T_key_seat).p;
  EXPECT_NEAR((second - first).norm(), 1.0, 0.05);
}

TEST(Sitting, AStreamedCentreOfMassIsTakenAtItsWord) {
  const Puppet puppet;
  auto frames = perform(puppet, between_standing(8.0, [&](double) { return sitting(puppet, 0.45); }));
  for (SuitFrame& frame : frames) {
    frame.center_of_mass = 0.5 * (frame[Segment::LeftToe].p + frame[Segment::RightFoot].p) + Vector3d(0, 0, 0.5);
  }
  EXPECT_TRUE(track(frames).sittings.empty()) << "a mass over the feet needs no seat";
}

TEST(Sitting, FinishClosesAnOpenBout) {
  const Puppet puppet;
  const Outcome outcome = track(perform(
      puppet, {{2.0, [](double) { return standing(); }}, {8.0, [&](double) { return sitting(puppet, 0.45); }}}));
  EXPECT_EQ(outcome.sittings.size(), 1u);
}

}  // namespace
}  // namespace kinemap::test
