// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/mapper/associate.hpp"
#include "tests/core/landmarks/contours.hpp"
#include "tests/core/mapper/wearer.hpp"

namespace kinemap {
namespace {

using test::level_rectangle;
using test::Wearer;

MapperConfig config() {
  MapperConfig c;
  c.hand.tip_m = 0.18;
  return c;
}

std::shared_ptr<const MapSnapshot> map_of(const Wearer& wearer, const MapperConfig& c = config()) {
  Mapper mapper(c);
  for (const auto& event : wearer.events) mapper.add(event);
  mapper.finish();
  return mapper.snapshot();
}

int count(const MapSnapshot& map, ObjectType type) {
  return static_cast<int>(
      std::count_if(map.objects.begin(), map.objects.end(), [type](const MapObject& o) { return o.type == type; }));
}

double rmse(const MapSnapshot& map, const std::vector<Pose>& truth, bool optimised) {
  double sum = 0.0;
  for (const auto& t : map.trajectory)
    sum += ((optimised ? t.T_map_pelvis : t.T_odom_pelvis).p - truth[t.id].p).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.trajectory.size()));
}

void trace_table(Wearer& wearer, double x, double y) {
  auto corners = level_rectangle({x, y, 0.74}, 0.0, 1.4, 0.8);
  corners.push_back(corners.front());
  wearer.trace(corners, {x, y - 5.0});
}

void trace_wall(Wearer& wearer, const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& stand) {
  wearer.walk_to(a.x() * 0.7 + stand.x() * 0.3, a.y() * 0.7 + stand.y() * 0.3);
  std::vector<Eigen::Vector3d> path;
  const int n = static_cast<int>((b - a).norm() / 0.2);
  for (int i = 0; i <= n; ++i) {
    const Eigen::Vector2d p = a + (b - a) * (static_cast<double>(i) / n);
    path.emplace_back(p.x(), p.y(), 1.2 + 0.2 * std::sin(i));
  }
  wearer.trace(path, stand);
}

/// One round through a 6 × 4 m room (lower left corner at −1, −1) with a table and a chair.
void round_trip(Wearer& wearer) {
  const Eigen::Vector2d middle(2.0, 1.0);
  trace_wall(wearer, {-0.5, -1.0}, {4.5, -1.0}, middle);
  wearer.walk_to(3.0, 0.0);
  trace_table(wearer, 3.0, 1.5);
  trace_wall(wearer, {5.0, -0.5}, {5.0, 2.5}, middle);
  trace_wall(wearer, {4.5, 3.0}, {-0.5, 3.0}, middle);
  wearer.sit(0.5, 2.0, -1.0);
  trace_wall(wearer, {-1.0, 2.5}, {-1.0, -0.5}, middle);
}

TEST(Mapper, ARoundOnPerfectOdometry) {
  Wearer wearer;
  round_trip(wearer);
  const auto map = map_of(wearer);
  EXPECT_EQ(count(*map, ObjectType::Wall), 4);
  EXPECT_EQ(count(*map, ObjectType::Table), 1);
  EXPECT_EQ(count(*map, ObjectType::Chair), 1);
  ASSERT_EQ(map->rooms.size(), 1u);
  EXPECT_NEAR(map->rooms[0].area_m2, 24.0, 0.2);
  EXPECT_EQ(map->graph.loop_closures, 0u);
  EXPECT_TRUE(map->unresolved.empty());
}

TEST(Mapper, ThreeRoundsCorrectTheDrift) {
  Wearer wearer(0.002);  // 7°/min
  for (int round = 0; round < 3; ++round) round_trip(wearer);
  const auto map = map_of(wearer);
  EXPECT_EQ(count(*map, ObjectType::Wall), 4);
  EXPECT_EQ(count(*map, ObjectType::Table), 1);
  EXPECT_EQ(count(*map, ObjectType::Chair), 1);
  EXPECT_EQ(map->graph.loop_closures, 12u);
  EXPECT_GT(rmse(*map, wearer.truth, false), 0.3);
  EXPECT_LT(rmse(*map, wearer.truth, true), 0.25 * rmse(*map, wearer.truth, false));
  ASSERT_EQ(map->rooms.size(), 1u);
  EXPECT_NEAR(map->rooms[0].area_m2, 24.0, 0.8);
  const Pose& last = map->trajectory.back().T_odom_pelvis;
  EXPECT_NEAR((map->T_map_odom * last.p - map->trajectory.back().T_map_pelvis.p).norm(), 0.0, 1e-9);
}

TEST(Mapper, TheFirstOfTwoWallsInOneGestureJoinsThePartsTheSecondMovesAlong) {
  Wearer wearer;
  round_trip(wearer);
  wearer.walk_to(1.5, 0.0);
  wearer.restart(60.0, 2.5);
  wearer.walk_to(3.0, 0.0);
  trace_table(wearer, 3.0, 1.5);
  wearer.sit(0.5, 2.0, -1.0);
  const Eigen::Vector2d middle(2.0, 1.0);
  trace_wall(wearer, {-0.5, -1.0}, {4.5, -1.0}, middle);
  wearer.walk_to(3.5, 2.0);
  std::vector<Eigen::Vector3d> round_the_corner;
  for (double y = 0.0; y < 3.0; y += 0.2) round_the_corner.emplace_back(5.0, y, 1.2 + 0.2 * std::sin(5.0 * y));
  for (double x = 5.0; x > 1.0; x -= 0.2) round_the_corner.emplace_back(x, 3.0, 1.2 + 0.2 * std::sin(5.0 * x));
  wearer.trace(round_the_corner, middle);
  const auto map = map_of(wearer);
  EXPECT_EQ(count(*map, ObjectType::Wall), 4);
  EXPECT_EQ(count(*map, ObjectType::Table), 1);
  EXPECT_EQ(count(*map, ObjectType::Chair), 1);
  EXPECT_EQ(map->graph.loop_closures, 5u);
  EXPECT_LT(rmse(*map, wearer.truth, true), 0.1);
}

TEST(Mapper, ASuitThatHardlyErrsGetsNarrowerSigmasAtTheEnd) {
  Wearer exact;
  for (int round = 0; round < 3; ++round) round_trip(exact);
  Mapper mapper(config());
  const auto sigma = [&mapper] {
    double sum = 0.0;
    for (const MapObject& o : mapper.snapshot()->objects) sum += o.sigma.heading_rad;
    return sum;
  };
  for (const auto& event : exact.events) mapper.add(event);
  const double expected = sigma();
  mapper.finish();
  EXPECT_LT(sigma(), 0.6 * expected);
}

TEST(Mapper, TwoEqualTablesSideBySideStayTwo) {
  Wearer wearer(0.0012);
  for (int round = 0; round < 3; ++round) {
    wearer.walk_to(1.0, 0.0);
    trace_table(wearer, 1.0, 1.5);
    wearer.walk_to(2.6, 0.0);
    trace_table(wearer, 2.6, 1.5);
  }
  const auto map = map_of(wearer);
  EXPECT_EQ(count(*map, ObjectType::Table), 2);
  for (const auto& o : map->objects) EXPECT_EQ(o.observations, 3);
}

TEST(Mapper, TwoFacesOfAPartitionStayTwo) {
  Wearer wearer;
  for (int round = 0; round < 2; ++round) {
    trace_wall(wearer, {0.0, 2.0}, {3.0, 2.0}, {1.5, 0.0});
    wearer.walk_to(5.0, 2.0);
    trace_wall(wearer, {3.0, 2.12}, {0.0, 2.12}, {1.5, 4.0});
    wearer.walk_to(-2.0, 2.0);
  }
  EXPECT_EQ(count(*map_of(wearer), ObjectType::Wall), 2);
}

TEST(Mapper, SameEventsSameMapToTheLastBit) {
  Wearer wearer(0.0012);
  for (int round = 0; round < 2; ++round) round_trip(wearer);
  const auto a = map_of(wearer), b = map_of(wearer);
  ASSERT_EQ(a->objects.size(), b->objects.size());
  for (std::size_t k = 0; k < a->objects.size(); ++k) EXPECT_EQ(a->objects[k].pose.p, b->objects[k].pose.p);
  for (std::size_t k = 0; k < a->trajectory.size(); ++k)
    EXPECT_EQ(a->trajectory[k].T_map_pelvis.p, b->trajectory[k].T_map_pelvis.p);
}

TEST(Mapper, ATraceOnNothingIsKeptAsUnresolved) {
  Wearer wearer;
  wearer.walk_to(1.0, 0.0);
  std::vector<Eigen::Vector3d> coil;  // through the air: neither level nor upright anywhere for long
  for (int i = 0; i < 60; ++i)
    coil.emplace_back(1.0 + 0.3 * std::cos(0.5 * i), 0.6 + 0.3 * std::sin(0.5 * i), 1.2 + 0.3 * std::sin(0.35 * i));
  wearer.trace(coil, {1.0, -1.0});
  const auto map = map_of(wearer);
  EXPECT_TRUE(map->objects.empty());
  ASSERT_EQ(map->unresolved.size(), 1u);
  EXPECT_FALSE(map->unresolved[0].reason.empty());
}

TEST(Mapper, TheTouchingPointIsEstimated) {
  // The wearer touches 0.18 m beyond the wrist, but 0.10 m is expected: a table drawn from all around tells.
  Wearer wearer;
  for (int round = 0; round < 2; ++round) {
    const auto c = level_rectangle({3.0, 1.5, 0.74}, 0.0, 1.4, 0.8);
    const Eigen::Vector2d around[] = {{3.0, -3.0}, {8.0, 1.5}, {3.0, 6.0}, {-2.0, 1.5}};
    wearer.walk_to(3.0, 0.0);
    for (std::size_t k = 0; k < 4; k += 2) wearer.trace({c[k], c[k + 1], c[(k + 2) % 4]}, around[k]);
  }
  MapperConfig wrong = config();
  wrong.hand.tip_m = 0.10;
  wrong.hand.body_point_sigma_m = 0.04;
  Mapper free(wrong);
  wrong.hand.tip_sigma_m = 0.0;
  Mapper fixed(wrong);
  for (const auto& event : wearer.events) free.add(event), fixed.add(event);
  free.finish(), fixed.finish();
  EXPECT_NEAR(free.graph().touch_points[0].p_hand.y(), -0.18, 0.03);
  EXPECT_EQ(fixed.graph().touch_points[0].p_hand.y(), -0.10);
}

TEST(Mapper, EachWearerHasATouchingPointOfTheOwn) {
  Wearer wearer;
  const auto draw = [&wearer](double stature_m, double touch_m, bool pivot) {
    wearer.stature_m = stature_m, wearer.touch_m = touch_m;
    if (pivot) wearer.pivot(0.01);
    wearer.walk_to(3.0, 0.0);
    trace_table(wearer, 3.0, 1.5);
  };
  draw(1.85, 0.18, true);
  draw(1.62, 0.09, true);
  draw(1.853, 0.18, false);
  const auto map = map_of(wearer, MapperConfig{});
  ASSERT_EQ(map->wearers.size(), 2u) << "the first one came back";
  EXPECT_EQ(map->wearers[0].hand.part, HandPart::Tips);
  EXPECT_EQ(map->wearers[1].hand.part, HandPart::Palm);
  EXPECT_NEAR(-map->wearers[0].hand.p_hand.y(), 0.18, 0.015);
  EXPECT_NEAR(-map->wearers[1].hand.p_hand.y(), 0.09, 0.015);
  ASSERT_TRUE(map->hand);
  EXPECT_EQ(map->hand->p_hand, map->wearers[0].hand.p_hand) << "who drew last";
  ASSERT_EQ(count(*map, ObjectType::Table), 1);
  EXPECT_EQ(map->objects[0].observations, 3);
}

TEST(Mapper, TheTrajectoryKeepsUpWithAWalk) {
  Wearer wearer;
  wearer.walk_to(10.0, 0.0);
  Mapper mapper(config());
  for (const auto& event : wearer.events) mapper.add(event);
  EXPECT_GT(mapper.snapshot()->trajectory.size() + 11, wearer.truth.size());
  const auto revision = mapper.snapshot()->revision;
  mapper.finish();
  mapper.finish();  // silence may come more than once
  EXPECT_EQ(mapper.snapshot()->trajectory.size(), wearer.truth.size());
  EXPECT_GT(mapper.snapshot()->revision, revision);
}

TEST(Mapper, NothingInNothingOut) {
  Mapper mapper(config());
  mapper.finish();
  EXPECT_EQ(mapper.snapshot()->revision, 0u);
  EXPECT_TRUE(mapper.snapshot()->objects.empty());
}

TEST(Gate, AgreesWithTheChiSquareTable) {
  // Wilson–Hilferty is good to 5 % for one dimension and 2 % for more.
  EXPECT_NEAR(gate(1.959964, 1), 3.841, 0.19);
  EXPECT_NEAR(gate(3.290527, 3), 16.266, 0.33);
  EXPECT_NEAR(gate(3.290527, 6), 22.458, 0.45);
}

}  // namespace
}  // namespace kinemap
