// SPDX-License-Identifier: Apache-2.0
// How different people trace: careful ones cleanly, careless ones with all that goes wrong; and the truth says what
// was.
#include <map>
#include <set>

#include "tests/tools/sim_fixture.hpp"

namespace kinemap::sim {
namespace {

std::vector<Interval> traces_of(const Session& session) {
  std::vector<Interval> traces;
  for (const auto& i : session.script().score.intervals)
    if (i.label == "trace") traces.push_back(i);
  return traces;
}

/// What occurs in the traces of some sessions.
struct Census {
  int gestures = 0, traces = 0, lift_offs = 0, chained = 0, split = 0;
};

Census census(double sloppiness) {
  Census c;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SimOptions options = seeded(seed);
    options.sloppiness = sloppiness;
    const auto session = session_of(options);
    std::map<int, int> objects;  // by gesture
    for (const auto& trace : traces_of(*session)) {
      ++c.traces;
      ++objects[trace.gesture];
      c.lift_offs += static_cast<int>(trace.lift_offs.size());
      c.split += trace.parts == 2 && trace.part == 2;
    }
    c.gestures += static_cast<int>(objects.size());
    for (const auto& [gesture, count] : objects) c.chained += count > 1;
  }
  return c;
}

TEST(SimHabits, TheCarefulDoOneObjectAGestureAndStayOnIt) {
  const Census c = census(0.0);
  EXPECT_EQ(c.lift_offs, 0);
  EXPECT_EQ(c.chained, 0);
  EXPECT_EQ(c.split, 0);
}

TEST(SimHabits, EachHabitOccursAndMostGesturesAreClean) {
  const Census usual = census(0.5), careless = census(1.0);
  for (const auto habit : {&Census::lift_offs, &Census::chained, &Census::split}) {
    EXPECT_GT(usual.*habit, 0);
    EXPECT_LT(usual.*habit, usual.gestures / 4);
    EXPECT_GT(careless.*habit, usual.*habit);
  }
}

TEST(SimHabits, IntervalsOfOneGestureFollowEachOther) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    SimOptions options = seeded(seed);
    options.sloppiness = 1.0;
    const auto traces = traces_of(*session_of(options));
    std::set<int> gestures;
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const Interval& t = traces[i];
      EXPECT_LT(t.begin_s, t.contact_begin_s);
      EXPECT_LT(t.contact_begin_s, t.contact_end_s);
      EXPECT_LT(t.contact_end_s, t.end_s);
      for (const auto& [from, to] : t.lift_offs) {
        EXPECT_GT(from, t.contact_begin_s);
        EXPECT_LT(to, t.contact_end_s);
      }
      if (i == 0) continue;
      EXPECT_GE(t.begin_s, traces[i - 1].end_s);
      if (t.gesture == traces[i - 1].gesture) {
        EXPECT_DOUBLE_EQ(t.begin_s, traces[i - 1].end_s);
        EXPECT_NE(t.object, traces[i - 1].object);
      } else {
        EXPECT_EQ(t.gesture, traces[i - 1].gesture + 1);
      }
      if (t.part == 2) {
        EXPECT_EQ(t.object, traces[i - 1].object);
        EXPECT_EQ(traces[i - 1].part, 1);
      }
    }
  }
}

/// The left hand rests on the hip during all of a gesture, however it is held and however many objects are drawn.
TEST(SimHabits, LeftHandStaysOnTheHip) {
  for (std::uint64_t seed = 21; seed <= 26; ++seed) {
    SimOptions options = seeded(seed);
    options.sloppiness = 1.0;
    const auto session = session_of(options);
    double farthest = 0.0;
    run(*session, [&](const Sample& s) {
      const Interval* trace = interval_at(*session, s.time_s, "trace");
      if (trace == nullptr || s.time_s < trace->contact_begin_s || s.time_s > trace->contact_end_s) return;
      farthest = std::max(farthest, (s.truth[kLeftHand].p - s.truth[kLeftUpperLeg].p).norm());
    });
    EXPECT_LT(farthest, 0.42) << seed;
  }
}

}  // namespace
}  // namespace kinemap::sim
