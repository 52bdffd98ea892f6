// SPDX-License-Identifier: Apache-2.0
// What the wearer truly does: stands on the feet, touches what is said to be touched, walks round the furniture.
#include "tests/tools/sim_fixture.hpp"

namespace kinemap::sim {
namespace {

/// Distance of a point from the object that an interval names: a wall's plane, a rectangle's outline.
double distance_to_object(const Building& building, int id, const Vec3& p) {
  for (const auto& w : building.walls) {
    if (w.id == id) return std::abs((p.head<2>() - w.a).dot(w.inward()));
  }
  std::array<Vec3, 4> corners;
  for (const auto& t : building.tables) {
    if (t.id != id) continue;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = lift(t.top.corners()[i], t.height);
  }
  for (const auto& s : building.screens) {
    if (s.id != id) continue;
    const Vec3 right = Vec3::UnitZ().cross(lift(direction(s.heading), 0)) * s.width / 2,
               up = Vec3::UnitZ() * s.height / 2;
    corners = {s.centre - right - up, s.centre + right - up, s.centre + right + up, s.centre - right + up};
  }
  double least = 1e9;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 &a = corners[i], d = corners[(i + 1) % 4] - a;
    least = std::min(least, (p - a - std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm());
  }
  return least;
}

/// Reaching for a chair, sitting, squatting and picking up bring the pelvis nearer to things than walking does.
bool upright(const Session& session, double t) {
  return !interval_at(session, t, "sit") && !interval_at(session, t, "distractor");
}

bool off_the_surface(const Interval& trace, double t) {
  return std::any_of(trace.lift_offs.begin(), trace.lift_offs.end(),
                     [t](const auto& lift) { return t >= lift.first - 0.02 && t <= lift.second + 0.02; });
}

class Seeds : public testing::TestWithParam<std::pair<int, Scene>> {
 protected:
  static std::unique_ptr<Session> session() {
    SimOptions options = seeded(static_cast<std::uint64_t>(GetParam().first));
    options.scene = GetParam().second;
    return session_of(options);
  }
};

TEST_P(Seeds, TouchingPointLiesOnTheObjectWhileInContact) {
  const auto session = Seeds::session();
  std::vector<double> errors;
  run(*session, [&](const Sample& s) {
    const Interval* trace = interval_at(*session, s.time_s, "trace");
    if (trace == nullptr || s.time_s < trace->contact_begin_s || s.time_s > trace->contact_end_s) return;
    if (off_the_surface(*trace, s.time_s)) return;
    errors.push_back(distance_to_object(session->building(), trace->object, session->to_building(s.p_map_touch)));
  });
  ASSERT_GT(errors.size(), 1000U);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.005);        // shaky hand
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.02);  // lift-offs and cut corners
  EXPECT_LT(errors.back(), 0.06);                     // a flat palm at the end of its reach
}

TEST_P(Seeds, StanceFeetDoNotSlide) {
  const auto session = Seeds::session();
  std::array<std::size_t, 2> plant{~std::size_t{0}, ~std::size_t{0}};
  std::array<Vec3, 2> put;
  double worst = 0.0;
  run(*session, [&](const Sample& s) {
    for (std::size_t f = 0; f < 2; ++f) {
      const FootState& state = session->gait().feet[f][s.index];
      const Vec3& ball = s.truth[f == 0 ? kRightToe : kLeftToe].p;
      if (!state.planted || interval_at(*session, s.time_s, "distractor:kneel")) {
        plant[f] = ~std::size_t{0};
      } else if (plant[f] != state.plant) {
        plant[f] = state.plant;
        put[f] = ball;
      } else {
        worst = std::max(worst, (ball - put[f]).norm());
      }
    }
  });
  EXPECT_LT(worst, 0.001);
}

TEST_P(Seeds, NobodyWalksThroughWallsOrFurniture) {
  const auto session = Seeds::session();
  double least = 1e9;
  run(*session, [&](const Sample& s) {
    const Vec3 pelvis = session->to_building(s.truth[kPelvis].p);
    if (upright(*session, s.time_s)) least = std::min(least, session->building().clearance(pelvis.head<2>()));
  });
  EXPECT_GT(least, 0.10);
}

TEST_P(Seeds, LeftHandIsOnTheHipAndTheRightOneOnItsWayBeforeContact) {
  const auto session = Seeds::session();
  std::vector<double> before(session->script().score.intervals.size(), 1e9);
  double farthest = 0.0, widest = 0.0;
  run(*session, [&](const Sample& s) {
    const Interval* trace = interval_at(*session, s.time_s, "trace");
    if (trace == nullptr) return;
    if (s.time_s <= trace->begin_s + 0.05) {
      before[static_cast<std::size_t>(trace - session->script().score.intervals.data())] =
          distance_to_object(session->building(), trace->object, session->to_building(s.p_map_touch));
    }
    if (s.time_s < trace->contact_begin_s || s.time_s > trace->contact_end_s) return;
    farthest = std::max(farthest, (s.truth[kLeftHand].p - s.truth[kLeftUpperLeg].p).norm());
    const Vec3 up = s.truth[kLeftUpperArm].p - s.truth[kLeftForearm].p,
               down = s.truth[kLeftHand].p - s.truth[kLeftForearm].p;
    widest = std::max(widest, std::acos(up.normalized().dot(down.normalized())));
  });
  EXPECT_LT(farthest, 0.40);
  EXPECT_LT(widest, radians(125.0));
  std::sort(before.begin(), before.end());
  EXPECT_GT(before[before.size() / 10], 0.02) << "the right hand should still be on its way when the gesture begins";
}

INSTANTIATE_TEST_SUITE_P(Sim, Seeds,
                         testing::Values(std::pair(1, Scene::Auto), std::pair(5, Scene::Auto),
                                         std::pair(8, Scene::Auto), std::pair(13, Scene::Auto),
                                         std::pair(3, Scene::TwinTables), std::pair(3, Scene::ChairRow),
                                         std::pair(3, Scene::TwinScreens), std::pair(3, Scene::ThinWall),
                                         std::pair(3, Scene::ObliqueWall)));

TEST(SimWearer, EverySeedGivesAPlausibleSession) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto session = session_of(seeded(seed));
    EXPECT_GE(session->duration_s(), 180.0);
    EXPECT_LE(session->duration_s(), 360.0);
    EXPECT_GE(session->script().round_ends_s.size(), 2U);
    const Building& b = session->building();
    EXPECT_GE(b.tables.size(), 2U);
    EXPECT_GE(b.chairs.size(), 1U);
    EXPECT_GE(session->script().visited.size(),
              (b.walls.size() + b.tables.size() + b.screens.size() + b.chairs.size()) / 2);
    int traces = 0, sittings = 0;
    for (const auto& i : session->script().score.intervals) traces += i.label == "trace", sittings += i.label == "sit";
    EXPECT_GE(traces, 10);
    EXPECT_GE(sittings, 1);
    EXPECT_EQ(b.doorways.size() + 1, b.rooms.size());
  }
}

/// Corner to corner, a wall's length is known only where its neighbours are touched as well.
TEST(SimWearer, NearlyEveryWallIsTouched) {
  std::size_t walls = 0, touched = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto session = session_of(seeded(seed));
    for (const auto& wall : session->building().walls) ++walls, touched += session->script().visited.count(wall.id);
  }
  EXPECT_GT(static_cast<double>(touched), 0.9 * static_cast<double>(walls)) << touched << " of " << walls;
}

TEST(SimWearer, WalksLikeAPerson) {
  const auto session = session_of(seeded(6));
  std::vector<double> speeds, heights, steps;
  Vec3 last = Vec3::Zero();
  run(*session, [&](const Sample& s) {
    const Vec3 p = s.truth[kPelvis].p;
    if (interval_at(*session, s.time_s, "walk"))
      speeds.push_back((p - last).head<2>().norm() * 60.0), heights.push_back(p.z());
    last = p;
  });
  const auto& right = session->gait().plants[0];
  for (std::size_t k = 1; k < right.size(); ++k) {
    const auto t = static_cast<double>(right[k].land) / 60.0;
    if (interval_at(*session, t, "walk")) steps.push_back((right[k].ankle - right[k - 1].ankle).norm() / 2);
  }
  std::sort(speeds.begin(), speeds.end());
  std::sort(steps.begin(), steps.end());
  EXPECT_GT(speeds[speeds.size() * 3 / 4], 0.7);
  EXPECT_LT(speeds[speeds.size() * 3 / 4], 1.4);
  EXPECT_GT(steps[steps.size() * 3 / 4], 0.40);
  EXPECT_LT(steps.back(), 0.80);
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double stature = session->wearer().body.stature;
  EXPECT_GT(*low, 0.46 * stature);
  EXPECT_LT(*high, 0.55 * stature);
  EXPECT_GT(*high - *low, 0.01) << "no bob";
}

TEST(SimWearer, SitsOnTheSeat) {
  const auto session = session_of(seeded(3));
  int checked = 0;
  run(*session, [&](const Sample& s) {
    const Interval* sit = interval_at(*session, s.time_s, "sit");
    if (sit == nullptr || s.time_s < sit->contact_begin_s + 0.6 || s.time_s > sit->contact_end_s - 0.1) return;
    for (const auto& chair : session->building().chairs) {
      if (chair.id != sit->object) continue;
      const Vec3 hips = session->to_building(s.truth[kPelvis].p);
      const double before = (hips.head<2>() - chair.seat).dot(direction(chair.heading));
      EXPECT_NEAR(hips.z() - chair.height, 0.09, 0.02);
      EXPECT_NEAR(before, 0.075, 0.05);
      // Thighs about level: the knees are not much lower than the hips.
      EXPECT_LT(s.truth[kRightUpperLeg].p.z() - s.truth[kRightLowerLeg].p.z(), 0.25);
      ++checked;
    }
  });
  EXPECT_GT(checked, 60);
}

TEST(SimWearer, StaturesAndShellsCanBeChosen) {
  for (const double stature : {1.55, 1.75, 1.95}) {
    for (const Shell shell : {Shell::Rectangle, Shell::LShape}) {
      SimOptions options = seeded(4);
      options.stature_m = stature;
      options.shell = shell;
      options.rooms = 2;
      const auto session = session_of(options);
      EXPECT_DOUBLE_EQ(session->wearer().body.stature, stature);
      EXPECT_EQ(session->building().rooms.size(), 2U);
      EXPECT_EQ(session->building().walls.size(), shell == Shell::Rectangle ? 8U : 10U);
      EXPECT_EQ(std::abs(session->wearer().p_hand_touch.y()) > 0.05, true);
      Sample first;
      ASSERT_TRUE(session->next(first));
      EXPECT_NEAR(first.truth[kPelvis].p.z(), 0.53 * stature, 0.03 * stature);
    }
  }
}

TEST(SimWearer, OptionsOutOfRangeAreRefused) {
  const auto refuses = [](const std::function<void(SimOptions&)>& change) {
    SimOptions options;
    change(options);
    return !Session::create(options);
  };
  EXPECT_TRUE(refuses([](SimOptions& o) { o.rooms = 4; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.rounds = 0; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.rate_hz = 0.0; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.stature_m = 3.0; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.speed = std::nan(""); }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.closure_spacing_m = 0.1; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.sloppiness = 1.5; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.packet_loss = 1.0; }));
  EXPECT_TRUE(refuses([](SimOptions& o) { o.room_size = std::array{2.0, 5.0}; }));
}

}  // namespace
}  // namespace kinemap::sim
