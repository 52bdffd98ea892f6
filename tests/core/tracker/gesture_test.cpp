// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

using Eigen::Vector3d;

Figure with_arms(Figure figure, const ArmSpec& left, const ArmSpec& right) {
  figure.arm[0] = left;
  figure.arm[1] = right;
  return figure;
}

double elbow_angle(const SuitFrame& frame) {
  const Vector3d& elbow = frame[Segment::LeftForearm].p;
  const Vector3d a = frame[Segment::LeftUpperArm].p - elbow;
  const Vector3d b = frame[Segment::LeftHand].p - elbow;
  return std::acos(a.normalized().dot(b.normalized()));
}

std::vector<HipStyle> styles() {
  std::vector<HipStyle> all;
  for (const bool fist : {false, true}) {
    for (const bool thumb_forward : {false, true}) {
      for (const Vector3d& shift : {Vector3d(0, 0, 0), Vector3d(0.07, 0, 0), Vector3d(-0.07, 0, 0),
                                    Vector3d(0, 0, 0.07), Vector3d(0, 0, -0.07)}) {
        all.push_back({fist, thumb_forward, shift});
      }
    }
  }
  return all;
}

std::string describe(const HipStyle& s) {
  std::ostringstream text;
  text << (s.fist ? "fist" : "flat") << (s.thumb_forward ? ", thumb forward" : ", thumb back") << ", shifted "
       << s.shift.transpose();
  return text.str();
}

TEST(Gesture, PuppetHoldsTheHandAsPeopleDo) {
  double least = 10;
  double most = 0;
  for (const HipStyle& style : styles()) {
    const Puppet puppet;
    const double angle = elbow_angle(puppet.truth(puppet.pose(with_arms(standing(), on_hip(style), hanging())), 0));
    least = std::min(least, angle / kDegree);
    most = std::max(most, angle / kDegree);
  }
  EXPECT_LT(least, 65);
  EXPECT_GT(most, 105);
  EXPECT_LT(most, 120);
}

TEST(Gesture, EveryWayToHoldTheHandGivesOneTrace) {
  for (const HipStyle& style : styles()) {
    for (const Case& c : cases()) {
      const Puppet puppet(c.stature_m, c.errors);
      const auto acts =
          between_standing(9.0, [&](double t) { return with_arms(standing(), on_hip(style), drawing(t)); });
      const Outcome outcome = track(perform(puppet, acts, c.sampling));
      EXPECT_EQ(outcome.traces.size(), 1u) << describe(style) << "; " << describe(c);
      if (outcome.traces.empty()) continue;
      EXPECT_NEAR(outcome.traces[0].begin_s, 2.45, 0.45) << describe(style) << "; " << describe(c);
      EXPECT_NEAR(outcome.traces[0].end_s, 11.4, 0.6) << describe(style) << "; " << describe(c);
    }
  }
}

TEST(Gesture, LeaningAndTwistingKeepIt) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto acts = between_standing(9.0, [&](double t) {
      Figure f = with_arms(standing(), on_hip(), drawing(t));
      const double x = std::sin(t);
      f.pelvis_pitch = 0.25 + 0.2 * x;
      f.trunk_pitch = 0.45 + 0.3 * x;
      f.chest_twist = 0.35 * std::cos(t);
      f.hips.x() = 0.15 * t;  // steps sideways along a table would look the same to the arm
      return f;
    });
    EXPECT_EQ(track(perform(puppet, acts, c.sampling)).traces.size(), 1u) << describe(c);
  }
}

struct Row {
  const char* name;
  std::function<ArmSpec(double)> left, right;
};

TEST(Gesture, OtherArmsGiveNoTrace) {
  const std::vector<Row> rows{
      {"hanging", [](double) { return hanging(); }, drawing},
      {"both hands on the hips", [](double) { return on_hip(); }, [](double) { return on_hip(); }},
      {"phone at the left ear", [](double) { return at_ear(); }, drawing},
      {"crossed arms", [](double) { return before_belly(); }, [](double) { return before_belly(); }},
      {"left arm before the belly", [](double) { return before_belly(); }, drawing},
      {"scratching the side", scratching, drawing},
      {"left hand in the pocket", [](double) { return in_pocket(); }, drawing},
      {"waving with both", waving, waving},
      {"typing", typing, typing},
      {"runner's arms", running_swing, [](double t) { return running_swing(t + 0.36); }},
  };
  for (const Row& row : rows) {
    for (const Case& c : cases()) {
      const Puppet puppet(c.stature_m, c.errors);
      const auto acts =
          between_standing(9.0, [&](double t) { return with_arms(standing(), row.left(t), row.right(t)); });
      const Outcome outcome = track(perform(puppet, acts, c.sampling));
      EXPECT_TRUE(outcome.traces.empty()) << row.name << "; " << describe(c);
    }
  }
}

// A hand in the lap is 8 cm from one on the hip: told apart at the usual error of an arm chain (3°), not always at
// twice that.
TEST(Gesture, LeftHandInTheLapWhileTheRightWorksIsNone) {
  for (Case c : cases()) {
    c.errors.arm_rad *= 0.5;
    const Puppet puppet(c.stature_m, c.errors);
    const auto acts =
        between_standing(9.0, [&](double t) { return with_arms(sitting(puppet, 0.45), in_lap(), drawing(t)); });
    EXPECT_TRUE(track(perform(puppet, acts, c.sampling)).traces.empty()) << describe(c);
  }
}

TEST(Gesture, SecondHandOnTheHipSuspendsIt) {
  const Puppet puppet;
  const auto one = [](double t) { return with_arms(standing(), on_hip(), drawing(t)); };
  const auto both = [](double) { return with_arms(standing(), on_hip(), on_hip()); };
  const std::vector<Act> acts{{2.0, [](double) { return standing(); }}, {5.0, one}, {4.0, both}, {6.0, one}};
  const Outcome outcome = track(perform(puppet, acts));
  ASSERT_EQ(outcome.traces.size(), 2u);
  EXPECT_LT(outcome.traces[0].end_s, 9.0);
  EXPECT_GT(outcome.traces[1].begin_s, 11.0);
}

// Short people draw the edge of a table beside their hip while they walk along it.
TEST(Gesture, TheRightHandMayDrawBesideItsHip) {
  for (const double stature_m : {1.55, 1.75, 1.95}) {
    const Puppet puppet(stature_m, {});
    const auto acts = between_standing(9.0, [](double t) {
      Figure f = with_arms(standing(), on_hip(), on_hip({.shift = {0.16, 0.04, 0.0}}));
      f.hips.x() = 0.15 * t;
      return f;
    });
    EXPECT_EQ(track(perform(puppet, acts)).traces.size(), 1u) << stature_m;
  }
}

// The wrist is at the crest then, as that of a hand which lies there.
TEST(Gesture, TheRightHandMayDrawBeforeItsHip) {
  for (const double stature_m : {1.55, 1.75, 1.95}) {
    const Puppet puppet(stature_m, {});
    const auto acts = between_standing(9.0, [](double t) {
      const ArmSpec right{ArmSpec::Origin::Hip, {0.08, 0.06, 0.03}, {1.0, 0.1, -0.2}, {-1.0, 0.3, 0.0}};
      Figure f = with_arms(standing(), on_hip(), right);
      f.hips.x() = 0.15 * t;
      return f;
    });
    EXPECT_EQ(track(perform(puppet, acts)).traces.size(), 1u) << stature_m;
  }
}

ArmSpec swinging(double t) {
  ArmSpec arm = hanging();
  arm.wrist.x() += 0.08 * std::sin(2.0 * std::numbers::pi * t / 1.1);
  arm.wrist.z() = -0.55;  // as good as straight
  return arm;
}

Figure standing_at(double x) {
  Figure f = standing();
  f.hips.x() = x;
  return f;
}

TEST(Gesture, TheRightArmThatSwingsWhileOneWalksIsNone) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto walk_from = [](double x) {
      return [x](double t) { return with_arms(walking(t, 1.0, {x, 0.0}), on_hip(), swinging(t)); };
    };
    const auto draw_at = [](double x) {
      return [x](double t) { return with_arms(standing_at(x), on_hip(), drawing(t)); };
    };
    // The left hand goes to the hip as the wearer sets out, and stays there on the way to the next thing.
    const std::vector<Act> acts{{2.0, [](double) { return standing(); }},
                                {4.0, walk_from(0.0)},
                                {6.0, draw_at(4.0)},
                                {4.0, walk_from(4.0)},
                                {6.0, draw_at(8.0)},
                                {2.0, [](double) { return standing_at(8.0); }}};
    const Outcome outcome = track(perform(puppet, acts, c.sampling));
    ASSERT_EQ(outcome.traces.size(), 2u) << describe(c);
    EXPECT_NEAR(outcome.traces[0].begin_s, 6.0, 1.0) << describe(c);
    EXPECT_NEAR(outcome.traces[0].end_s, 12.0, 1.0) << describe(c);
    EXPECT_NEAR(outcome.traces[1].begin_s, 16.0, 1.0) << describe(c);
  }
}

TEST(Gesture, TheRightArmThatHangsAtRestIsNone) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto hang = [](double) { return with_arms(standing(), on_hip(), swinging(0.0)); };
    const auto draw = [](double t) { return with_arms(standing(), on_hip(), drawing(t)); };
    // Thinks with the hand on the hip, draws, looks at it; turns to the next thing.
    const auto turn = [](double t) {
      Figure f = with_arms(standing(), on_hip(), swinging(0.0));
      f.heading = 0.8 * t;
      return f;
    };
    const std::vector<Act> acts{{2.0, [](double) { return standing(); }},
                                {4.0, hang},
                                {6.0, draw},
                                {2.0, hang},
                                {2.0, turn},
                                {6.0, draw},
                                {3.0, hang},
                                {2.0, [](double) { return standing(); }}};
    const Outcome outcome = track(perform(puppet, acts, c.sampling));
    ASSERT_EQ(outcome.traces.size(), 2u) << describe(c);
    EXPECT_NEAR(outcome.traces[0].begin_s, 6.0, 1.0) << describe(c);
    EXPECT_NEAR(outcome.traces[0].end_s, 12.0, 1.0) << describe(c);
    EXPECT_NEAR(outcome.traces[1].begin_s, 16.0, 1.0) << describe(c);
    EXPECT_NEAR(outcome.traces[1].end_s, 22.0, 1.0) << describe(c);
  }
}

// The hand is as low, and the wearer as fast, but it stays beside the body.
TEST(Gesture, AHandThatFollowsAnEdgeWhileOneWalksDraws) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const auto acts = between_standing(9.0, [](double t) { return with_arms(walking(t, 0.8), on_hip(), hanging()); });
    EXPECT_EQ(track(perform(puppet, acts, c.sampling)).traces.size(), 1u) << describe(c);
  }
}

TEST(Gesture, AHandThatStraysOnceItLayOnTheHipKeepsIt) {
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(-0.20, 0.03, 0.20), {0.05, -0.12, 0.0}}) {
    const Puppet puppet;
    const auto acts = between_standing(9.0, [&](double t) {
      const bool astray = t > 3.0 && t < 6.0;
      return with_arms(standing(), on_hip({.shift = astray ? shift : Eigen::Vector3d::Zero()}), drawing(t));
    });
    EXPECT_EQ(track(perform(puppet, acts)).traces.size(), 1u) << shift.transpose();
  }
}

TEST(Trace, ContactsReproduceTheHandInTheOdomFrame) {
  const Puppet puppet;
  const auto acts = between_standing(12.0, [&](double t) {
    Figure f = walking(t, 0.3);
    return with_arms(f, on_hip(), drawing(t));
  });
  const auto frames = perform(puppet, acts);
  const Outcome outcome = track(frames);
  ASSERT_EQ(outcome.traces.size(), 1u);
  const Trace& trace = outcome.traces[0];
  std::size_t k = 0;
  double last_s = -1.0;
  Vector3d last_wrist = Vector3d::Constant(1e3);
  Vector3d last_point = Vector3d::Constant(1e3);
  for (const HandContact& contact : trace.contacts) {
    while (frames[k].time_s < contact.time_s) ++k;
    ASSERT_EQ(frames[k].time_s, contact.time_s);
    const KeyPose& key = outcome.key_poses.at(contact.key_pose);
    EXPECT_LE(key.time_s, contact.time_s);
    if (contact.key_pose + 1 < outcome.key_poses.size()) {
      EXPECT_GT(outcome.key_poses[contact.key_pose + 1].time_s, contact.time_s) << "the latest key pose is meant";
    }
    const Pose T_odom_hand = key.T_odom_pelvis * contact.T_key_hand;
    EXPECT_NEAR((T_odom_hand.p - frames[k][Segment::RightHand].p).norm(), 0.0, 1e-9);
    EXPECT_NEAR(T_odom_hand.q.angularDistance(frames[k][Segment::RightHand].q), 0.0, 1e-7);
    EXPECT_GT(contact.time_s, last_s);
    const Vector3d point = T_odom_hand * Vector3d(0, -0.15, 0);
    EXPECT_TRUE((T_odom_hand.p - last_wrist).norm() >= 0.01 - 1e-9 || (point - last_point).norm() >= 0.01 - 1e-9 ||
                contact.time_s - last_s >= 0.1 - 1e-9)
        << "thinned";
    last_s = contact.time_s;
    last_wrist = T_odom_hand.p;
    last_point = point;
  }
  EXPECT_GE(trace.contacts.front().time_s, trace.begin_s);
  EXPECT_LE(trace.contacts.back().time_s, trace.end_s);
  EXPECT_LT(trace.contacts.size(), frames.size() / 2) << "thinned by distance and time";
  EXPECT_GT(trace.contacts.size(), 100u);
}

// A hand at rest still gives one contact each 0.1 s, whatever the rate; a moving one gives them each centimetre.
TEST(Trace, ThinningDoesNotDependOnTheRate) {
  std::vector<std::size_t> counts;
  for (const double rate : {60.0, 120.0, 240.0}) {
    const Puppet puppet;
    const auto acts =
        between_standing(9.0, [&](double t) { return with_arms(standing(), on_hip(), drawing(0.5 * t)); });
    const Outcome outcome = track(perform(puppet, acts, {rate, 0.0}));
    ASSERT_EQ(outcome.traces.size(), 1u);
    counts.push_back(outcome.traces[0].contacts.size());
  }
  EXPECT_NEAR(static_cast<double>(counts[0]), static_cast<double>(counts[2]), 0.35 * static_cast<double>(counts[2]));
}

TEST(Trace, ShortDropOutsDoNotSplitLongOnesDo) {
  for (const auto& [gap_s, expected] : {std::pair{0.25, 1u}, std::pair{1.2, 2u}}) {
    const Puppet puppet;
    const auto acts = between_standing(12.0, [&, gap = gap_s](double t) {
      return with_arms(standing(), t > 6 && t < 6 + gap ? hanging() : on_hip(), drawing(t));
    });
    Sampling sampling;
    sampling.blend_s = 0.4;
    EXPECT_EQ(track(perform(puppet, acts, sampling)).traces.size(), expected) << gap_s;
  }
}

TEST(Trace, TooShortOrWithoutMotionIsRejectedAndCounted) {
  const Puppet puppet;
  const auto pointing = [](const ArmSpec& left) {
    return [left](double) { return with_arms(standing(), left, drawing(0)); };
  };
  const std::vector<Act> still{{2.0, pointing(hanging())}, {6.0, pointing(on_hip())}, {2.0, pointing(hanging())}};
  const Outcome without_motion = track(perform(puppet, still));
  EXPECT_TRUE(without_motion.traces.empty());
  EXPECT_EQ(without_motion.stats.traces_rejected, 1u);

  const auto brief = between_standing(2.0, [&](double t) { return with_arms(standing(), on_hip(), drawing(3 * t)); });
  TrackerConfig config;
  config.traces.min_duration_s = 1.8;
  EXPECT_EQ(track(perform(puppet, brief), config).traces.size(), 1u);
  config.traces.min_duration_s = 3.0;
  const Outcome too_short = track(perform(puppet, brief), config);
  EXPECT_TRUE(too_short.traces.empty());
  EXPECT_EQ(too_short.stats.traces_rejected, 1u);
}

TEST(Trace, MemoryIsBoundedAndTheRestIsCounted) {
  const Puppet puppet;
  TrackerConfig config;
  config.traces.max_contacts = 50;
  const auto acts = between_standing(20.0, [&](double t) { return with_arms(standing(), on_hip(), drawing(t)); });
  const Outcome outcome = track(perform(puppet, acts), config);
  ASSERT_EQ(outcome.traces.size(), 1u);
  EXPECT_EQ(outcome.traces[0].contacts.size(), 50u);
  EXPECT_GT(outcome.stats.contacts_thinned_out, 50u);
  EXPECT_NEAR(outcome.traces[0].end_s, 22.4, 0.6) << "it still ends when the gesture ends";
}

TEST(Trace, FinishClosesAnOpenTrace) {
  const Puppet puppet;
  const std::vector<Act> acts{{2.0, [](double) { return standing(); }},
                              {6.0, [](double t) { return with_arms(standing(), on_hip(), drawing(t)); }}};
  EXPECT_EQ(track(perform(puppet, acts)).traces.size(), 1u);
}

TEST(Trace, KeyPosesComeEachSecondAndAtTheStart) {
  const Puppet puppet;
  const auto acts = between_standing(9.0, [&](double t) { return with_arms(standing(), on_hip(), drawing(t)); });
  const Outcome outcome = track(perform(puppet, acts));
  ASSERT_EQ(outcome.traces.size(), 1u);
  const Trace& trace = outcome.traces[0];
  EXPECT_EQ(outcome.key_poses.at(trace.contacts.front().key_pose).time_s, trace.contacts.front().time_s);
  std::size_t during = 0;
  for (const KeyPose& key : outcome.key_poses) during += key.time_s >= trace.begin_s && key.time_s <= trace.end_s;
  EXPECT_NEAR(static_cast<double>(during), trace.end_s - trace.begin_s + 1, 1.0);
}

}  // namespace
}  // namespace kinemap::test
