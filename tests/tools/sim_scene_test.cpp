// SPDX-License-Identifier: Apache-2.0
// Rooms in which things can be taken for each other.
#include <set>

#include "tests/tools/sim_fixture.hpp"
#include "tools/sim/scene.hpp"

namespace kinemap::sim {
namespace {

std::unique_ptr<Session> scene_of(Scene scene, std::uint64_t seed) {
  SimOptions options = seeded(seed);
  options.scene = scene;
  return session_of(options);
}

/// Pairs of tables of one size whose tops are at most `most` apart.
int twin_tables(const Building& b, double most) {
  int pairs = 0;
  for (std::size_t i = 0; i < b.tables.size(); ++i) {
    for (std::size_t k = i + 1; k < b.tables.size(); ++k) {
      const bool same = (b.tables[i].top.half - b.tables[k].top.half).norm() < 1e-9;
      const double apart = gap(b.tables[i].top, b.tables[k].top);
      pairs += same && apart > 0.05 && apart < most;
    }
  }
  return pairs;
}

int twin_screens(const Building& b) {
  int pairs = 0;
  for (std::size_t i = 0; i < b.screens.size(); ++i) {
    for (std::size_t k = i + 1; k < b.screens.size(); ++k) {
      const bool same = b.screens[i].width == b.screens[k].width && b.screens[i].table == b.screens[k].table;
      pairs += same && (b.screens[i].centre - b.screens[k].centre).norm() < 0.8;
    }
  }
  return pairs;
}

int chairs_side_by_side(const Building& b) {
  int pairs = 0;
  for (std::size_t i = 0; i < b.chairs.size(); ++i) {
    for (std::size_t k = i + 1; k < b.chairs.size(); ++k) pairs += (b.chairs[i].seat - b.chairs[k].seat).norm() < 0.71;
  }
  return pairs;
}

/// Smallest angle between two walls of the room, modulo 90°.
double least_square(const Building& b) {
  double worst = 0.0;
  for (const auto& wall : b.walls)
    worst =
        std::max(worst, std::abs(std::remainder(heading_of(wall.along()) - heading_of(b.walls[0].along()), kPi / 2)));
  return worst;
}

/// Pairs of walls of two rooms in one line; pairs back to back.
int walls_in_line(const Building& b) {
  int pairs = 0;
  for (const auto& v : b.walls) {
    for (const auto& w : b.walls)
      pairs += v.room < w.room && v.along().dot(w.along()) > 0.999 && std::abs((w.a - v.a).dot(v.inward())) < 0.01;
  }
  return pairs;
}

constexpr std::uint64_t kSeeds = 6;

TEST(SimScene, FurnitureThatLooksAlikeIsThereAndTouched) {
  int tables = 0, screens = 0, chairs = 0, flush = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    tables += twin_tables(scene_of(Scene::TwinTables, seed)->building(), 1.06) > 0;
    screens += twin_screens(scene_of(Scene::TwinScreens, seed)->building()) > 0;
    chairs += chairs_side_by_side(scene_of(Scene::ChairRow, seed)->building()) >= 2;
    const auto session = scene_of(Scene::FlushScreen, seed);
    for (const auto& screen : session->building().screens) {
      for (const auto& wall : session->building().walls) {
        flush += screen.big && wall.room == screen.room &&
                 std::abs(heading_of(wall.inward()) - screen.heading) < 1e-9 &&
                 (screen.centre.head<2>() - wall.a).dot(wall.inward()) < 0.04;
      }
    }
  }
  // Now and then a small room has no place for them.
  EXPECT_GE(tables, kSeeds - 1);
  EXPECT_GE(screens, kSeeds - 1);
  EXPECT_GE(chairs, kSeeds - 1);
  EXPECT_GE(flush, kSeeds - 1);
}

TEST(SimScene, ShellsAreAsTheirNamesSay) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    EXPECT_EQ(scene_of(Scene::LRoom, seed)->building().walls.size(), 6U);
    const auto hall = scene_of(Scene::Hall, seed);
    EXPECT_GT(hall->building().walls[0].length(), 8.2);
    EXPECT_LT(hall->building().walls[1].length(), 4.01);
    const double off = least_square(scene_of(Scene::ObliqueWall, seed)->building());
    EXPECT_GT(off, radians(19.9));
    EXPECT_LT(off, radians(40.1));
    EXPECT_GE(walls_in_line(scene_of(Scene::Flat, seed)->building()), 2);
  }
}

TEST(SimScene, BothFacesOfAThinWallAreDrawn) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const auto session = scene_of(Scene::ThinWall, seed);
    const Building& b = session->building();
    std::set<int> drawn;
    ASSERT_EQ(b.doorways.size(), 1U);
    EXPECT_GE(b.doorways[0].thickness, 0.1);
    EXPECT_LE(b.doorways[0].thickness, 0.2);
    for (const auto& wall : b.walls)
      if (wall.doorway && session->script().visited.count(wall.id) != 0) drawn.insert(wall.room);
    EXPECT_EQ(drawn.size(), 2U);
  }
}

TEST(SimScene, MostlyPlainWhenNotAskedFor) {
  int plain = 0;
  std::set<Scene> seen;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Scene scene = drawn_scene(seeded(seed));
    plain += scene == Scene::Plain;
    seen.insert(scene);
  }
  EXPECT_GT(plain, 100);
  EXPECT_EQ(seen.size(), scene_names().size() - 1);
  SimOptions sized = seeded(1);
  sized.room_size = {4.0, 5.0};
  for (sized.seed = 1; sized.seed <= 50; ++sized.seed) EXPECT_LT(drawn_scene(sized), Scene::ThinWall);
}

TEST(SimScene, AShapeThatContradictsIsRefused) {
  SimOptions options = seeded(1);
  options.scene = Scene::Flat;
  options.rooms = 1;
  EXPECT_FALSE(Session::create(options));
  options.rooms = 2;
  EXPECT_TRUE(Session::create(options));
  options.shell = Shell::LShape;
  EXPECT_FALSE(Session::create(options));
}

/// Level way of the body between two times, m.
double way(const Score& score, double from_s, double to_s) {
  double sum = 0.0;
  for (auto i = static_cast<std::size_t>(from_s * score.rate_hz) + 1; static_cast<double>(i) <= to_s * score.rate_hz;
       ++i)
    sum += (score.ground[i] - score.ground[i - 1]).norm();
  return sum;
}

TEST(SimScene, KnownThingsAreTouchedNoSoonerThanAsked) {
  int closures = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    SimOptions options = seeded(seed);
    options.closure_spacing_m = 30.0;
    const auto session = session_of(options);
    const Score& score = session->script().score;
    std::set<int> known;
    double last_s = 0.0;
    for (const auto& i : score.intervals) {
      if (i.object == 0 || known.insert(i.object).second || i.part > 1) continue;
      ++closures;
      EXPECT_GT(way(score, last_s, i.contact_begin_s), 28.0);  // the way is smoothed
      last_s = i.contact_end_s;
    }
  }
  EXPECT_GT(closures, 8);
}

}  // namespace
}  // namespace kinemap::sim
