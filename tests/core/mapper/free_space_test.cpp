// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/free_space.hpp"

#include <gtest/gtest.h>

#include "core/mapper/closure.hpp"

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

constexpr double kMost = 12.0;

/// A wearer who goes from place to place in steps of 0.2 m, and things known to the millimetre where he has been.
class Scene {
 public:
  explicit Scene(const Eigen::Vector2d& begin) {
    state.graph.touch_points.emplace_back();
    state.graph.poses.push_back(level_pose({begin.x(), begin.y(), 0.95}, 0.0));
    state.graph.priors.push_back({0, state.graph.poses[0], graph::Matrix6::Identity() * 1e3});
  }

  /// Odometry between here and there errs by `sigma_m` (the first step of it).
  Scene& walk_to(double x, double y, double sigma_m = 1e-3) {
    const Eigen::Vector3d from = state.graph.poses.back().p, to(x, y, from.z());
    const int n = static_cast<int>(std::ceil((to - from).norm() / 0.2));
    for (int k = 1; k <= n; ++k) step(level_pose(from + (to - from) * k / n, 0.0), k == 1 ? sigma_m : 1e-3);
    return *this;
  }

  Scene& rectangle(LandmarkKind kind, double x, double y, double z, double heading, double length, double width) {
    Landmark thing;
    thing.kind = kind;
    thing.x = {x, y, z, heading, length, width, 0.0};
    const std::size_t k = add(thing);
    for (int n = 0; n < graph::dimension(kind); ++n)
      state.graph.landmark_priors.push_back({k, n, thing.x[static_cast<std::size_t>(n)], 1e-3});
    touch({x, y, z}, k);
    return *this;
  }

  /// Along y = `y`, touched from `from_x` to `to_x` and from `from_x_2` to `to_x_2`, by somebody south of it.
  Scene& wall(double y, double from_x, double to_x, double from_x_2, double to_x_2) {
    Landmark thing;
    thing.x = {-0.5 * std::numbers::pi, 0.0};
    thing.anchor = {0.0, y, 0.0};
    const std::size_t k = add(thing);
    for (double x = from_x; x <= to_x; x += 0.1) touch({x, y, 1.2}, k);
    for (double x = from_x_2; x <= to_x_2; x += 0.1) touch({x, y, 1.2}, k);
    return *this;
  }

  std::size_t seat(double ahead) {
    Landmark thing;
    thing.kind = LandmarkKind::Seat;
    const Pose T_i_seat = level_pose({ahead, 0.0, -0.5}, 0.0);
    const Eigen::Vector3d p = state.graph.poses.back() * T_i_seat.p;
    thing.x = {p.x(), p.y(), p.z(), 0.0};
    const std::size_t k = add(thing);
    state.observations.back().seat = state.graph.seats.size();
    state.graph.seats.push_back({here(), k, T_i_seat, 0.06, 0.03, 0.15, {graph::Loss::Kind::Cauchy, 2.0}});
    return k;
  }

  [[nodiscard]] double cost() const { return free_space_cost(state, nullptr, kMost); }

  MapState state;

 private:
  [[nodiscard]] std::size_t here() const { return state.graph.poses.size() - 1; }

  void step(const Pose& to, double sigma_m) {
    graph::BetweenFactor way;
    way.i = here(), way.j = here() + 1;
    way.T_i_j = state.graph.poses.back().inverse() * to;
    way.sqrt_information *= 1e3;
    way.sqrt_information.topLeftCorner<2, 2>() = Eigen::Matrix2d::Identity() / sigma_m;
    state.graph.between.push_back(way);
    state.graph.poses.push_back(to);
  }

  std::size_t add(const Landmark& thing) {
    const std::size_t k = state.graph.landmarks.size();
    state.graph.landmarks.push_back(thing);
    state.landmarks.push_back({static_cast<std::uint32_t>(k + 1), 1, 0.0, 1.0, 0.0});
    state.observations.push_back({k, here(), state.graph.contacts.size(), 0, 0, 0.0, 1.0, {}});
    return k;
  }

  void touch(const Eigen::Vector3d& p, std::size_t landmark) {
    graph::ContactFactor contact;
    contact.i = here(), contact.landmark = landmark;
    contact.T_i_hand = {state.graph.poses.back().inverse() * p, Eigen::Quaterniond::Identity()};
    state.graph.contacts.push_back(contact);
    ++state.observations.back().contacts;
  }
};

TEST(FreeSpace, NobodyWalksThroughATable) {
  Scene through({0, 0}), round({0, 0}), past({0, 0});
  for (Scene* s : {&through, &round, &past}) s->rectangle(LandmarkKind::Table, 2, 0, 0.74, 0.3, 1.4, 1.2);
  EXPECT_EQ(through.walk_to(4, 0).cost(), kMost) << "evidence, and no veto";
  EXPECT_EQ(round.walk_to(0, 1.5).walk_to(4, 1.5).walk_to(4, 0).cost(), 0.0);
  EXPECT_EQ(past.walk_to(0.9, 0).walk_to(0, 0).cost(), 0.0) << "up to it";
}

TEST(FreeSpace, GoingThroughTwiceIsTwoPiecesOfEvidenceTurningRoundInItIsOne) {
  Scene twice({0, 0}), once({0, 0});
  for (Scene* s : {&twice, &once}) s->rectangle(LandmarkKind::Table, 2, 0, 0.74, 0.0, 1.4, 1.2);
  EXPECT_EQ(twice.walk_to(6, 0).walk_to(0, 0).cost(), 2.0 * kMost);
  EXPECT_EQ(once.walk_to(2, 0).walk_to(0, 0).cost(), kMost);
}

TEST(FreeSpace, DriftMayExplainIt) {
  Scene s({0, 0});
  s.rectangle(LandmarkKind::Table, 2, 0, 0.74, 0.0, 1.4, 0.8).walk_to(4, 0, 2.0);
  EXPECT_GT(s.cost(), 0.0);
  EXPECT_LT(s.cost(), 0.5);
}

TEST(FreeSpace, NobodyWalksThroughAWallOtherThanAtADoorway) {
  Scene through({1, 0}), door({2, 0}), beside({4, 0});
  for (Scene* s : {&through, &door, &beside}) s->wall(1.0, 0.0, 1.6, 2.4, 3.6);
  EXPECT_GT(through.walk_to(0.8, 3).cost(), 5.0);
  EXPECT_EQ(door.walk_to(2, 3).cost(), 0.0);
  EXPECT_EQ(beside.walk_to(4, 3).cost(), 0.0);
}

TEST(FreeSpace, LeaningOverTheLineOfAWallIsNotGoingThroughIt) {
  Scene s({1, 0});
  s.wall(1.0, 0.0, 1.6, 2.4, 3.6).walk_to(0.8, 1.05).walk_to(0.8, 0);
  EXPECT_LT(s.cost(), 1.0);
}

TEST(FreeSpace, ThingsExcludeEachOther) {
  const auto with = [](LandmarkKind kind, double x, double z, double heading = 0.0) {
    Scene s({0, -3});
    s.rectangle(LandmarkKind::Table, 0, 0, 0.74, 0.0, 1.4, 0.8).rectangle(kind, x, 0, z, heading, 1.4, 0.8);
    return s.walk_to(2, -3).cost();
  };
  EXPECT_EQ(with(LandmarkKind::Table, 0.8, 0.74), kMost);
  EXPECT_EQ(with(LandmarkKind::Table, 1.42, 0.74), 0.0) << "side by side";
  EXPECT_EQ(with(LandmarkKind::Table, 1.3, 0.74), 0.0) << "measured a little too large";
  EXPECT_EQ(with(LandmarkKind::Table, 0.8, 1.2), 0.0) << "one above the other";
  EXPECT_EQ(with(LandmarkKind::Screen, 0.1, 1.1), 0.0) << "screens stand on tables";
  EXPECT_EQ(Scene({0, -3}).rectangle(LandmarkKind::Table, 0.8, 0, 0.74, 0, 1.4, 0.8).wall(0.4, 0, 1.6, 2, 3).cost(), 0)
      << "at the wall";
  EXPECT_GT(Scene({0, -3}).rectangle(LandmarkKind::Table, 0.8, 0, 0.74, 0, 1.4, 0.8).wall(0, 0, 1.6, 2, 3).cost(), 4.0);
}

TEST(FreeSpace, WhatIsOnAnotherFloorIsNotInTheWay) {
  Scene s({0, 0});
  s.rectangle(LandmarkKind::Table, 2, 0, 3.74, 0.3, 1.4, 1.2).state.landmarks.back().floor_z = 3.0;
  EXPECT_EQ(s.walk_to(4, 0).cost(), 0.0) << "walked below it";
  s.wall(1.5, 1.0, 1.6, 1.7, 3.0).state.landmarks.back().floor_z = 0.0;
  EXPECT_EQ(s.walk_to(4, 1).cost(), 0.0);
  s.rectangle(LandmarkKind::Table, 2, 1.5, 3.74, 0.0, 1.4, 1.2).state.landmarks.back().floor_z = 3.0;
  EXPECT_EQ(s.cost(), 0.0) << "a wall below it";
  s.state.landmarks.back().floor_z = 0.0;
  EXPECT_GT(s.cost(), 0.0);
}

/// A seat that may be either of two that look the same; if it were the second, the way to it had led through a table.
MapState between_two_seats() {
  Scene s({0, 0});
  s.seat(1.0);
  s.walk_to(0, 1.6).seat(1.0);
  s.rectangle(LandmarkKind::Table, -1.5, 1.6, 0.74, 0.0, 1.2, 0.8).walk_to(0, 3).walk_to(-3, 3);
  s.walk_to(-3, 0.8, 0.6).walk_to(0, 0.8).seat(1.0);
  return s.state;
}

TEST(FreeSpace, TellsWhichOfTwoItIs) {
  MapperConfig config;
  config.association.seat_density_per_m2 = 0.05;
  for (const bool used : {false, true}) {
    config.association.free_space_most = used ? kMost : 0.0;
    MapState state = between_two_seats();
    LoopCloser closer(config);
    EXPECT_EQ(closer.resolve(state, 3), used);
    EXPECT_EQ(state.observations.back().landmark, used ? 0U : 3U);
  }
}

TEST(FreeSpace, TakesBackAClosureThatLedTheWayThroughATable) {
  MapperConfig config;
  for (const bool used : {false, true}) {
    config.association.free_space_most = used ? kMost : 0.0;
    Scene s({0, 0});
    s.walk_to(0, 1.6).seat(1.0);
    s.rectangle(LandmarkKind::Table, -1.5, 1.6, 0.74, 0.0, 1.2, 1.2).walk_to(0, 3).walk_to(-3, 3);
    s.walk_to(-3, 0.6, 0.6).walk_to(3, 0.6).walk_to(-3, 0.6).walk_to(0, 0.6);
    merge(s.state, s.seat(1.0), {0, 0, 0.0, 4, 0.0});  // which is 1 m away
    LoopCloser closer(config);
    ASSERT_TRUE(closer.settle(s.state, 30));
    EXPECT_EQ(closer.revise(s.state), used);
    EXPECT_EQ(s.state.observations.front().landmark == s.state.observations.back().landmark, !used);
  }
}

}  // namespace
}  // namespace kinemap
