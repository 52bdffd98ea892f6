// SPDX-License-Identifier: Apache-2.0
// What the suit makes of it: constant bones, feet that stand, drift of the size that the table says.
#include "tests/tools/sim_fixture.hpp"

namespace kinemap::sim {
namespace {

TEST(SimSuit, ReportedBonesAreConstantAndNotTheTrueOnes) {
  const auto session = session_of(seeded(2, 120.0));
  std::array<double, kBones> low, high, truth{};
  low.fill(1e9);
  high.fill(0.0);
  run(*session, [&](const Sample& s) {
    for (std::size_t i = 1; i < kBones; ++i) {
      const auto parent = static_cast<std::size_t>(kParent[i]);
      const double length = (s.reported[i].p - s.reported[parent].p).norm();
      low[i] = std::min(low[i], length);
      high[i] = std::max(high[i], length);
      truth[i] = (s.truth[i].p - s.truth[parent].p).norm();
    }
  });
  double different = 0.0;
  for (std::size_t i = 1; i < kBones; ++i) {
    EXPECT_LT(high[i] - low[i], 1e-9) << bone_name(i);
    different = std::max(different, std::abs(low[i] / truth[i] - 1.0));
  }
  EXPECT_GT(different, 0.005);
  EXPECT_LT(different, 0.06);
}

TEST(SimSuit, ReportedStanceFeetStayWhereTheyWerePut) {
  const auto session = session_of(seeded(10, 60.0));
  std::array<std::size_t, 2> plant{~std::size_t{0}, ~std::size_t{0}};
  std::array<Vec3, 2> put;
  std::vector<double> slides;
  run(*session, [&](const Sample& s) {
    for (std::size_t f = 0; f < 2; ++f) {
      const FootState& state = session->gait().feet[f][s.index];
      const Vec3& ball = s.reported[f == 0 ? kRightToe : kLeftToe].p;
      if (!state.planted || interval_at(*session, s.time_s, "distractor:kneel")) continue;
      if (plant[f] != state.plant) plant[f] = state.plant, put[f] = ball;
      slides.push_back((ball - put[f]).norm());
    }
  });
  std::sort(slides.begin(), slides.end());
  EXPECT_LT(slides[slides.size() * 99 / 100], 0.01);
}

TEST(SimSuit, StartsWhereTheWearerIs) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto session = session_of(seeded(seed));
    Sample first;
    ASSERT_TRUE(session->next(first));
    EXPECT_LT(level_gap(first), 1e-9);
    EXPECT_LT(first.truth[kPelvis].q.angularDistance(first.reported[kPelvis].q), 1e-6);
    EXPECT_NEAR(first.truth[kPelvis].p.z(), first.reported[kPelvis].p.z(), 0.05);  // legs entered with wrong lengths
    EXPECT_LT(first.truth[kPelvis].p.head<2>().norm(), 0.5);
  }
}

/// Median over seeds of the gap between the reported and the true pelvis when the first round ends, in the 3.9 × 8.7 m
/// room. A round here is a working one: walls, tables, screens and chairs on the way, some 50–70 m walked in three to
/// four minutes. A bare lap along the four walls (21 m, half a minute) ends only 0.15–0.3 m off by the same table: bias
/// and random walk turn the heading by 1–3° in that time, not by the 14° that 0.7 m need; those take four minutes, or
/// metal on the way.
double median_gap(Severity drift) {
  std::vector<double> gaps;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SimOptions options = seeded(seed);
    options.drift = drift;
    options.rooms = 1;
    options.shell = Shell::Rectangle;
    options.room_size = {3.9, 8.7};
    const auto session = session_of(options);
    double gap = 0.0;
    run(
        *session, [&](const Sample& s) { gap = level_gap(s); }, session->script().round_ends_s.front());
    gaps.push_back(gap);
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps[gaps.size() / 2];
}

TEST(SimSuit, AWorkingRoundEndsAsFarOffAsTheTableSays) {
  const double usual = median_gap(Severity::Default);
  EXPECT_GT(usual, 0.7);
  EXPECT_LT(usual, 1.5);
  EXPECT_LT(median_gap(Severity::Good), 0.5 * usual);
  EXPECT_GT(median_gap(Severity::Bad), 1.5 * usual);
}

TEST(SimSuit, RollAndPitchStayWithinTheTable) {
  const auto session = session_of(seeded(7));
  double worst = 0.0;
  run(*session, [&](const Sample& s) {
    const Vec3 up_truth = s.truth[kT8].q.conjugate() * Vec3::UnitZ(),
               up = s.reported[kT8].q.conjugate() * Vec3::UnitZ();
    worst = std::max(worst, std::acos(std::min(1.0, up_truth.dot(up))));
  });
  EXPECT_GT(worst, radians(0.3));
  EXPECT_LT(worst, radians(1.0 * std::sqrt(2.0) + 0.01));
}

TEST(SimSuit, TheHandIsAsGoodAsArmAndBody) {
  const auto session = session_of(seeded(9));
  double sum = 0.0;
  std::size_t n = 0;
  run(*session, [&](const Sample& s) {  // right wrist in the pelvis frame
    const Vec3 truth = s.truth[kPelvis].q.conjugate() * (s.truth[kRightHand].p - s.truth[kPelvis].p);
    const Vec3 reported = s.reported[kPelvis].q.conjugate() * (s.reported[kRightHand].p - s.reported[kPelvis].p);
    sum += (truth - reported).squaredNorm();
    ++n;
  });
  const double rms = std::sqrt(sum / static_cast<double>(n));
  EXPECT_GT(rms, 0.015);
  EXPECT_LT(rms, 0.08);
}

}  // namespace
}  // namespace kinemap::sim
