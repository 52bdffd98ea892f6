// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

using Eigen::Vector3d;

// Walks, draws, sits, draws while walking slowly. The odd speed keeps steps from ending on a frame to the last bit.
std::vector<SuitFrame> session(const Puppet& puppet, const Sampling& sampling = {}) {
  const auto draw = [](Figure f, double t) {
    f.arm[0] = on_hip();
    f.arm[1] = drawing(t);
    return f;
  };
  const auto at = [](Figure f, double x) {
    f.hips.x() += x;
    return f;
  };
  return perform(puppet,
                 {{5.0, [=](double t) { return walking(t, 1.037); }},
                  {9.0, [=](double t) { return at(draw(standing(), t), 5.185); }},
                  {3.0, [=](double) { return at(standing(), 5.185); }},
                  {10.0, [=, &puppet](double) { return at(sitting(puppet, 0.45), 5.185); }},
                  {3.0, [=](double) { return at(standing(), 5.185); }},
                  {10.0,
                   [=](double t) {
                     return draw(walking(t, 0.311, {5.185, 0.0}), t);
                   }},
                  {4.0,
                   [=](double t) {
                     return walking(t, 1.037, {8.295, 0.0});
                   }}},
                 sampling);
}

void expect_well_ordered(const Outcome& outcome) {
  KeyPoseId emitted = 0;
  for (const Event& event : outcome.events) {
    if (const auto* key = std::get_if<KeyPose>(&event)) {
      EXPECT_EQ(key->id, emitted);
      ++emitted;
    } else if (const auto* trace = std::get_if<Trace>(&event)) {
      for (const HandContact& contact : trace->contacts) EXPECT_LT(contact.key_pose, emitted);
    } else {
      EXPECT_LT(std::get<Sitting>(event).key_pose, emitted);
    }
  }
}

TEST(Tracker, EventsOnlyReferToKeyPosesBefore) {
  for (const Case& c : cases()) {
    const Puppet puppet(c.stature_m, c.errors);
    const Outcome outcome = track(session(puppet, c.sampling));
    EXPECT_EQ(outcome.traces.size(), 2u) << describe(c);
    EXPECT_EQ(outcome.sittings.size(), 1u) << describe(c);
    EXPECT_EQ(outcome.stats.traces, outcome.traces.size());
    EXPECT_EQ(outcome.stats.sittings, outcome.sittings.size());
    EXPECT_EQ(outcome.stats.key_poses, outcome.key_poses.size());
    expect_well_ordered(outcome);
  }
}

TEST(Tracker, SameFramesSameEvents) {
  const Puppet puppet;
  const auto frames = session(puppet);
  const Outcome a = track(frames);
  const Outcome b = track(frames);
  ASSERT_EQ(a.key_poses.size(), b.key_poses.size());
  for (std::size_t i = 0; i < a.key_poses.size(); ++i) {
    EXPECT_EQ(a.key_poses[i].T_odom_pelvis.p, b.key_poses[i].T_odom_pelvis.p);
    EXPECT_EQ(a.key_poses[i].path_m, b.key_poses[i].path_m);
  }
}

// Nothing depends on where the suit's world begins or where it faces.
TEST(Tracker, MovesWithTheWorld) {
  const Puppet puppet(1.75, {0.02, 0.02, 0.05, 9});
  auto frames = session(puppet);
  const Outcome here = track(frames);
  const Pose T_there_here = level_pose({120.0, -45.0, 7.5}, 2.2);
  for (SuitFrame& frame : frames) {
    for (Pose& segment : frame.segments) segment = T_there_here * segment;
  }
  const Outcome there = track(frames);

  ASSERT_EQ(here.events.size(), there.events.size());
  for (std::size_t i = 0; i < here.key_poses.size(); ++i) {
    const Pose moved = T_there_here * here.key_poses[i].T_odom_pelvis;
    EXPECT_EQ(here.key_poses[i].time_s, there.key_poses[i].time_s);
    EXPECT_NEAR((moved.p - there.key_poses[i].T_odom_pelvis.p).norm(), 0.0, 1e-9);
    EXPECT_NEAR(here.key_poses[i].path_m, there.key_poses[i].path_m, 1e-9);
    EXPECT_NEAR(here.key_poses[i].turn_rad, there.key_poses[i].turn_rad, 1e-9);
    ASSERT_EQ(here.key_poses[i].p_pelvis_stance.has_value(), there.key_poses[i].p_pelvis_stance.has_value());
  }
  for (std::size_t i = 0; i < here.traces.size(); ++i) {
    ASSERT_EQ(here.traces[i].contacts.size(), there.traces[i].contacts.size());
    for (std::size_t k = 0; k < here.traces[i].contacts.size(); ++k) {
      EXPECT_NEAR((here.traces[i].contacts[k].T_key_hand.p - there.traces[i].contacts[k].T_key_hand.p).norm(), 0, 1e-9);
    }
  }
  for (std::size_t i = 0; i < here.sittings.size(); ++i) {
    EXPECT_EQ(here.sittings[i].key_pose, there.sittings[i].key_pose);
    EXPECT_NEAR((here.sittings[i].T_key_seat.p - there.sittings[i].T_key_seat.p).norm(), 0, 1e-9);
    EXPECT_NEAR(here.sittings[i].height_m, there.sittings[i].height_m, 1e-9);
  }
}

/// A tracker dies after each of `deaths` (indices of frames) and another one goes on, told what the first one noted
/// after each frame. No frame is lost.
Outcome track_with_deaths(const std::vector<SuitFrame>& frames, const std::vector<std::size_t>& deaths) {
  Outcome out;
  Tracker tracker{TrackerConfig{}};
  Interrupted noted;
  std::vector<Event> events;
  auto death = deaths.begin();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    events.clear();
    tracker.step(frames[i], events);
    for (const Event& event : events) {
      if (const auto* key_pose = std::get_if<KeyPose>(&event)) {
        out.key_poses.push_back(*key_pose);
        continue;
      }
      if (const auto* trace = std::get_if<Trace>(&event)) out.traces.push_back(*trace), noted.trace.reset();
      if (const auto* sitting = std::get_if<Sitting>(&event)) out.sittings.push_back(*sitting), noted.sitting.reset();
    }
    auto trace = tracker.take_unfinished_trace();
    auto sitting = tracker.take_unfinished_sitting();
    if (trace) append(noted.trace, *trace);
    if (sitting) append(noted.sitting, *sitting);
    if (death == deaths.end() || i != *death) continue;
    ++death;
    noted.key_poses = out.key_poses;
    noted.since_key_pose = tracker.since_key_pose();
    tracker = Tracker(TrackerConfig{});
    tracker.resume(noted, 0.0);
  }
  events.clear();
  tracker.finish(events);
  for (const Event& event : events)
    if (const auto* key_pose = std::get_if<KeyPose>(&event)) out.key_poses.push_back(*key_pose);
  return out;
}

// What a tracker that died had seen of a gesture is not lost, wherever in it that was.
TEST(Tracker, AnotherOneGoesOnInTheMiddleOfAGesture) {
  const Puppet puppet;
  const auto frames = session(puppet);
  const Outcome whole = track(frames);
  ASSERT_EQ(whole.traces.size(), 2u);
  ASSERT_EQ(whole.sittings.size(), 1u);
  const auto way = [](const Outcome& outcome) {
    double sum = 0.0;
    for (const KeyPose& key_pose : outcome.key_poses) sum += key_pose.path_m;
    return sum;
  };
  const auto place = [](const Outcome& outcome, const Sitting& sitting) {
    return (outcome.key(sitting.key_pose) * sitting.T_key_seat).p;
  };
  for (std::size_t first = 50; first < 500; first += 50) {
    std::vector<std::size_t> deaths;
    for (std::size_t at = first; at < frames.size(); at += 500) deaths.push_back(at);
    const Outcome torn = track_with_deaths(frames, deaths);
    EXPECT_NEAR(way(torn), way(whole), 0.05) << first;
    ASSERT_EQ(torn.traces.size(), whole.traces.size()) << first;
    for (std::size_t i = 0; i < whole.traces.size(); ++i) {
      EXPECT_EQ(torn.traces[i].begin_s, whole.traces[i].begin_s);
      EXPECT_NEAR(torn.traces[i].end_s, whole.traces[i].end_s, 1e-9);
      EXPECT_EQ(torn.traces[i].stature_m, whole.traces[i].stature_m);
      ASSERT_EQ(torn.traces[i].contacts.size(), whole.traces[i].contacts.size()) << first;
      for (std::size_t k = 0; k < whole.traces[i].contacts.size(); ++k)
        EXPECT_EQ(torn.traces[i].contacts[k].time_s, whole.traces[i].contacts[k].time_s);
    }
    ASSERT_EQ(torn.sittings.size(), whole.sittings.size()) << first;
    EXPECT_NEAR((place(torn, torn.sittings[0]) - place(whole, whole.sittings[0])).norm(), 0.0, 0.005) << first;
    EXPECT_NEAR(torn.sittings[0].height_m, whole.sittings[0].height_m, 0.005);
  }
}

std::vector<SuitFrame> gesture_of_ten_seconds() {
  return perform(Puppet{}, between_standing(10.0, [](double t) {
                   Figure f = standing();
                   f.arm = {on_hip(), drawing(t)};
                   return f;
                 }));
}

/// From `time_s` on the suit's world is another one, and nobody saw the wearer for `silence_s` before it. The first
/// frame in it.
std::vector<SuitFrame>::iterator move_world(std::vector<SuitFrame>& frames, double time_s, const Pose& T_new_old,
                                            double silence_s) {
  const auto first =
      std::find_if(frames.begin(), frames.end(), [=](const SuitFrame& frame) { return frame.time_s >= time_s; });
  first->discontinuity = true;
  for (auto frame = first; frame != frames.end(); ++frame) {
    frame->time_s += silence_s;
    for (Pose& segment : frame->segments) segment = T_new_old * segment;
  }
  return first;
}

TEST(Tracker, AGestureGoesOnWhenTheSuitsWorldJumpsFromOneFrameToTheNext) {
  auto frames = gesture_of_ten_seconds();
  const Outcome whole = track(frames);
  ASSERT_EQ(whole.traces.size(), 1u);
  const Pose T_new_old = level_pose({5, -3, 0}, 2.0);
  const auto jumped = move_world(frames, 6.0, T_new_old, 0.0);
  const Outcome outcome = track(frames);
  ASSERT_EQ(outcome.traces.size(), 1u);
  EXPECT_EQ(outcome.traces[0].begin_s, whole.traces[0].begin_s);
  EXPECT_EQ(outcome.traces[0].end_s, whole.traces[0].end_s);
  std::size_t after = 0;
  for (const HandContact& contact : outcome.traces[0].contacts) {
    const bool in_new_world = contact.time_s >= jumped->time_s;
    after += in_new_world;
    const Pose& T_odom_key = outcome.key(contact.key_pose);
    EXPECT_LT((T_odom_key.p - (in_new_world ? T_new_old : Pose{}) * Eigen::Vector3d(0, 0, T_odom_key.p.z())).norm(),
              1.0)
        << "each contact refers to a key pose of its own world";
  }
  EXPECT_GT(after, 5u);
  EXPECT_NEAR(double(outcome.traces[0].contacts.size()), double(whole.traces[0].contacts.size()), 1.0);
}

TEST(Tracker, AGestureGoesOnAfterASilenceWhereTheHandHasWaited) {
  auto frames = gesture_of_ten_seconds();
  const Outcome whole = track(frames);
  ASSERT_EQ(whole.traces.size(), 1u);
  move_world(frames, 6.0, level_pose({1, -0.5, 0}, -2.0), 1.5);
  const Outcome outcome = track(frames);
  ASSERT_EQ(outcome.traces.size(), 1u);
  EXPECT_NEAR(outcome.traces[0].end_s, whole.traces[0].end_s + 1.5, 1e-9);
  EXPECT_NEAR(double(outcome.traces[0].contacts.size()), double(whole.traces[0].contacts.size()), 1.0);
}

TEST(Tracker, DiscontinuityClosesWhatIsOpen) {
  const Puppet puppet;
  const auto acts = between_standing(16.0, [&](double t) {
    Figure f = t < 8 ? sitting(puppet, 0.45) : standing();
    if (t >= 8) f.arm = {on_hip(), drawing(t)};
    return f;
  });
  auto frames = perform(puppet, acts);
  for (const double at : {7.0, 14.0}) {
    std::erase_if(frames, [at](const SuitFrame& frame) { return frame.time_s >= at - 0.6 && frame.time_s < at; });
    for (SuitFrame& frame : frames) {
      if (frame.time_s >= at) {
        frame.discontinuity = true;
        break;
      }
    }
  }
  const Outcome outcome = track(frames);
  ASSERT_EQ(outcome.sittings.size(), 2u);
  EXPECT_LE(outcome.sittings[0].end_s, 7.0);
  EXPECT_GE(outcome.sittings[1].begin_s, 7.0);
  ASSERT_EQ(outcome.traces.size(), 2u);
  EXPECT_LE(outcome.traces[0].end_s, 14.0);
  EXPECT_GE(outcome.traces[1].begin_s, 14.0);
  for (const Trace& trace : outcome.traces) {
    bool after_break = false;
    for (const HandContact& contact : trace.contacts) {
      after_break = after_break || outcome.key_poses[contact.key_pose].time_s >= 14.0;
    }
    EXPECT_EQ(after_break, trace.begin_s >= 14.0) << "no contact refers across the break";
  }
  expect_well_ordered(outcome);
}

// Hours of sitting with the hand on the hip hold a bounded state: nothing can be seen of it but that the events stay
// small.
TEST(Tracker, ALongBoutStaysBounded) {
  const Puppet puppet;
  TrackerConfig config;
  config.sitting.max_samples = 16;
  auto frames = perform(puppet,
                        between_standing(120.0,
                                         [&](double t) {
                                           Figure f = sitting(puppet, 0.45);
                                           f.hips.y() = 0.02 * std::sin(t);
                                           return f;
                                         }),
                        {60.0});
  const Outcome outcome = track(frames, config);
  ASSERT_EQ(outcome.sittings.size(), 1u);
  EXPECT_NEAR(outcome.sittings[0].height_m, 0.45, 0.01);
  EXPECT_NEAR(outcome.key_poses[outcome.sittings[0].key_pose].time_s, 62.0, 25.0) << "samples cover the whole bout";
}

TEST(Tracker, FinishTwiceAddsNothing) {
  const Puppet puppet;
  std::vector<Event> events;
  Tracker tracker{TrackerConfig{}};
  for (const SuitFrame& frame : session(puppet)) tracker.step(frame, events);
  tracker.finish(events);
  const std::size_t count = events.size();
  tracker.finish(events);
  EXPECT_EQ(events.size(), count);
}

TEST(Tracker, NothingComesOfNothing) {
  std::vector<Event> events;
  Tracker tracker{TrackerConfig{}};
  tracker.finish(events);
  EXPECT_TRUE(events.empty());
}

}  // namespace
}  // namespace kinemap::test
