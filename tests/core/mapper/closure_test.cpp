// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/closure.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace kinemap {
namespace {

/// A seat 1 m before each of the poses, which stand on a line `apart` metres from each other (known to 1 cm), and all
/// of which were taken for one visit each to the same seat.
MapState seats_taken_for_one(const std::vector<double>& apart) {
  MapState state;
  graph::Landmark seat;
  seat.kind = graph::LandmarkKind::Seat;
  seat.x = {1.0, 0.0, 0.45, 0.0, 0.0, 0.0, 0.0};
  state.graph.landmarks = {seat};
  state.landmarks = {{1, 0, 0.0, 0.0, 0.0}};
  for (std::size_t k = 0; k <= apart.size(); ++k) {
    const double way = k == 0 ? 0.0 : apart[k - 1];
    const Pose T_step = level_pose({way, 0.0, 0.0}, 0.0);
    state.graph.poses.push_back(k == 0 ? Pose{} : state.graph.poses.back() * T_step);
    if (k == 0)
      state.graph.priors.push_back({0, {}, graph::Matrix6::Identity() * 1e3});
    else
      state.graph.between.push_back({k - 1, k, T_step, graph::Matrix6::Identity() * 1e2, {}});
    graph::SeatFactor factor;
    factor.i = k;
    factor.T_i_seat = level_pose({1.0, 0.0, 0.45}, 0.0);
    factor.sigma_level_m = 0.06, factor.sigma_z_m = 0.03, factor.sigma_heading_rad = 0.15;
    factor.loss = {graph::Loss::Kind::Cauchy, 2.0};
    state.graph.seats.push_back(factor);
    const double time = 10.0 * static_cast<double>(k);
    state.observations.push_back({0, static_cast<KeyPoseId>(k), 0, 0, k, time, time + 5.0});
    state.landmarks[0].last_seen_s = time + 5.0;
    ++state.landmarks[0].observations;
  }
  return state;
}

/// A wall along the x axis that was touched once over each of the stretches, by somebody south of it whose odometry is
/// good to a millimetre.
MapState wall_touched_along(const std::vector<Interval>& stretches) {
  MapState state;
  graph::Landmark wall;
  wall.x = {-0.5 * std::numbers::pi, 0.0};
  state.graph.landmarks = {wall};
  state.landmarks = {{1, 0, 0.0, 0.0, 0.0}};
  state.graph.touch_points.emplace_back();
  for (const Interval& stretch : stretches) {
    ObservationRecord visit;
    visit.key_pose = static_cast<KeyPoseId>(state.graph.poses.size());
    visit.first_contact = state.graph.contacts.size();
    for (double x = stretch.lo; x <= stretch.hi; x += 0.1) {
      const Pose T_map_pelvis = level_pose({x, -0.5, 0.9}, 0.0);
      const std::size_t k = state.graph.poses.size();
      if (k == 0)
        state.graph.priors.push_back({0, T_map_pelvis, graph::Matrix6::Identity() * 1e3});
      else
        state.graph.between.push_back(
            {k - 1, k, state.graph.poses.back().inverse() * T_map_pelvis, graph::Matrix6::Identity() * 1e3, {}});
      state.graph.poses.push_back(T_map_pelvis);
      graph::ContactFactor contact;
      contact.i = k;
      contact.T_i_hand = level_pose({0.0, 0.5, 0.3}, 0.0);
      state.graph.contacts.push_back(contact);
    }
    visit.contacts = state.graph.contacts.size() - visit.first_contact;
    state.observations.push_back(visit);
    ++state.landmarks[0].observations;
  }
  return state;
}

TEST(Candidates, AreThoseWithinWhatASuitTwiceAsBadWouldDrift) {
  constexpr double kDrift = 0.2, kApart = 0.7;  // m: 3 σ with what else two sittings differ by
  MapState state = seats_taken_for_one({kApart});
  state.graph.between[0].sqrt_information.diagonal().head<2>().setConstant(1.0 / kDrift);
  const std::size_t newcomer = split(state, 1);
  MapperConfig config;
  ASSERT_TRUE(LoopCloser{config}.settle(state, 30));
  const auto marginals = graph::Marginals::compute(state.graph);
  ASSERT_TRUE(marginals);
  for (const double doubt : {1.0, 2.0}) {
    config.association.doubt = doubt;
    const auto found = candidates(state, newcomer, *marginals, config.association);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].evidence > 0.0, doubt > 1.0) << found[0].evidence;
  }
}

// Little is known of the way between the visits. Two seats 3 cm apart cannot be two; at 60 cm they may well be.
TEST(Candidates, TwoInOnePlaceAreOne) {
  for (const double apart : {0.03, 0.6}) {
    MapState state = seats_taken_for_one({apart});
    state.graph.between[0].sqrt_information.diagonal().head<2>().setConstant(1.0 / 0.6);
    const std::size_t newcomer = split(state, 1);
    const MapperConfig config;
    ASSERT_TRUE(LoopCloser{config}.settle(state, 30));
    const auto marginals = graph::Marginals::compute(state.graph);
    ASSERT_TRUE(marginals);
    const auto found = candidates(state, newcomer, *marginals, config.association);
    ASSERT_EQ(found.size(), 1U) << apart;
    EXPECT_EQ(found[0].evidence > 0.0, apart < 0.4) << apart << " m: " << found[0].evidence;
  }
}

/// Things of one kind, of which the last is a newcomer whose place is known to 0.2 m.
MapState seen_again(graph::LandmarkKind kind, const std::vector<Eigen::Vector2d>& places) {
  MapState state;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const bool newcomer = k + 1 == places.size();
    graph::Landmark landmark;
    landmark.kind = kind;
    landmark.x = {places[k].x(), places[k].y(), 0.72, 0.0, 1.6, 0.8, 0.0};
    state.graph.landmarks.push_back(landmark);
    for (int i = 0; i < graph::dimension(kind); ++i)
      state.graph.landmark_priors.push_back(
          {k, i, landmark.x[static_cast<std::size_t>(i)], newcomer && i < 2 ? 0.2 : 0.02});
    state.landmarks.push_back({newcomer ? 0 : static_cast<std::uint32_t>(k + 1), 1, 0.0, 0.0, 0.0});
  }
  return state;
}

/// Evidence that the last one is the first one.
double evidence_of(const MapState& state, const MapperConfig::Association& config) {
  const auto marginals = graph::Marginals::compute(state.graph);
  if (!marginals) throw std::runtime_error("no marginals");
  for (const Candidate& c : candidates(state, state.graph.landmarks.size() - 1, *marginals, config))
    if (c.landmark == 0) return c.evidence;
  return -HUGE_VAL;
}

TEST(Candidates, DesksStandSideBySide) {
  MapperConfig::Association config;
  config.doubt = 1.5;
  for (const auto& [place, flush] : {std::pair{Eigen::Vector2d(0.0, 0.76), true},
                                     {Eigen::Vector2d(1.5, 0.0), true},
                                     {Eigen::Vector2d(0.1, -0.1), false}}) {
    const MapState state = seen_again(graph::LandmarkKind::Table, {{0.0, 0.0}, place});
    config.neighbour_share = 0.0;
    const double anywhere = evidence_of(state, config);
    config.neighbour_share = 0.2;
    const double flushly = evidence_of(state, config);
    EXPECT_EQ(flushly > 0.0, !flush) << place.transpose() << ": " << flushly;
    EXPECT_GT(anywhere - flushly, flush ? 1.0 : 0.0);
    EXPECT_LT(anywhere - flushly, flush ? 100.0 : 0.5);
  }
}

TEST(Candidates, ScreensStandSideBySide) {
  MapperConfig::Association config;
  config.doubt = 1.5;
  const MapState beside = seen_again(graph::LandmarkKind::Screen, {{0.0, 0.0}, {0.0, 1.55}}),
                 behind = seen_again(graph::LandmarkKind::Screen, {{0.0, 0.0}, {1.55, 0.0}});
  const double beside_before = [&] {
    config.neighbour_share = 0.0;
    return evidence_of(beside, config);
  }();
  const double behind_before = evidence_of(behind, config);
  config.neighbour_share = 0.2;
  EXPECT_LT(evidence_of(beside, config), beside_before - 1.0);
  EXPECT_GT(evidence_of(behind, config), behind_before - 0.1);
}

TEST(Candidates, WhereSeatsAreMoreSeatsAreToBeExpected) {
  const MapperConfig::Association config;
  const double alone = evidence_of(seen_again(graph::LandmarkKind::Seat, {{0.0, 0.0}, {0.3, 0.0}}), config),
               in_a_row = evidence_of(
                   seen_again(graph::LandmarkKind::Seat, {{0.0, 0.0}, {0.6, 0.0}, {-0.6, 0.0}, {0.3, 0.0}}), config),
               far_from_others = evidence_of(
                   seen_again(graph::LandmarkKind::Seat, {{0.0, 0.0}, {2.0, 0.0}, {-2.0, 0.0}, {0.3, 0.0}}), config);
  EXPECT_LT(in_a_row, alone - 0.5);
  EXPECT_NEAR(far_from_others, alone, 1e-6);
}

/// Two seats 2 m apart, a way of which little is known (0.8 m), and two seats again, so far from where the first ones
/// are as `off` says.
MapState seats_before_and_after_a_long_way(const std::array<double, 2>& off) {
  MapState state;
  const std::array<Eigen::Vector2d, 4> at{{{0.0, 0.0}, {0.0, 2.0}, {off[0], 0.0}, {off[1], 2.0}}};
  for (std::size_t k = 0; k < at.size(); ++k) {
    state.graph.poses.push_back(level_pose({at[k].x(), at[k].y(), 0.0}, 0.0));
    if (k == 0) {
      state.graph.priors.push_back({0, state.graph.poses[0], graph::Matrix6::Identity() * 1e3});
    } else {
      graph::Matrix6 information = graph::Matrix6::Identity() * 1e2;
      if (k == 2) information.diagonal().head<2>().setConstant(1.0 / 0.8);
      state.graph.between.push_back(
          {k - 1, k, state.graph.poses[k - 1].inverse() * state.graph.poses[k], information, {}});
    }
    graph::Landmark seat;
    seat.kind = graph::LandmarkKind::Seat;
    seat.x = {at[k].x() + 1.0, at[k].y(), 0.45, 0.0, 0.0, 0.0, 0.0};
    state.graph.landmarks.push_back(seat);
    const double time = 10.0 * static_cast<double>(k);
    state.landmarks.push_back({k < 3 ? static_cast<std::uint32_t>(k + 1) : 0, 1, time, time + 5.0, 0.0});
    graph::SeatFactor factor;
    factor.i = k;
    factor.landmark = k;
    factor.T_i_seat = level_pose({1.0, 0.0, 0.45}, 0.0);
    factor.sigma_level_m = 0.06, factor.sigma_z_m = 0.03, factor.sigma_heading_rad = 0.15;
    state.graph.seats.push_back(factor);
    state.observations.push_back({k, k, 0, 0, k, time, time + 5.0});
  }
  return state;
}

/// Where nothing comes twice.
MapperConfig together() {
  MapperConfig config;
  config.association.joint_evidence = -10.0;
  return config;
}

TEST(JointClosure, WhatIsUncertainAloneIsCertainTogetherWhereNothingComesTwice) {
  constexpr double kDrift = 1.4;  // m
  MapState state = seats_before_and_after_a_long_way({kDrift, kDrift});
  LoopCloser closer{together()};
  ASSERT_TRUE(closer.settle(state, 30));
  const auto marginals = graph::Marginals::compute(state.graph);
  ASSERT_TRUE(marginals);
  for (const std::size_t seat : {2U, 3U})
    for (const Candidate& c : candidates(state, seat, *marginals, MapperConfig{}.association))
      EXPECT_LT(c.evidence, 0.0) << seat << " alone";
  EXPECT_TRUE(closer.resolve(state, 3));
  closer.reconsider(state);
  for (const std::size_t seat : {2U, 3U}) EXPECT_FALSE(state.graph.landmarks[seat].active) << seat;
  EXPECT_NEAR(state.graph.poses[3].p.x(), 0.0, 0.1);
  EXPECT_EQ(state.summary.loop_closures, 2U);
}

TEST(JointClosure, LikeThingsComeInRows) {
  MapState state = seats_before_and_after_a_long_way({1.4, 1.4});  // two rows of seats may well be 1.4 m apart
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_FALSE(closer.resolve(state, 3));
  for (const std::size_t seat : {2U, 3U}) EXPECT_TRUE(state.graph.landmarks[seat].active) << seat;
}

TEST(JointClosure, NotWhatDoesNotFitTogether) {
  MapState state = seats_before_and_after_a_long_way({1.4, 0.4});
  LoopCloser closer{together()};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_FALSE(closer.resolve(state, 3));
  for (const std::size_t seat : {2U, 3U}) EXPECT_TRUE(state.graph.landmarks[seat].active) << seat;
}

TEST(Split, TheVisitTakesItsFactorsAndTimesWithIt) {
  MapState state = seats_taken_for_one({0.0, 0.0});
  const std::size_t alone = split(state, 2);
  ASSERT_EQ(alone, 1U);
  EXPECT_EQ(state.graph.landmarks[1].x, state.graph.landmarks[0].x);
  EXPECT_EQ(state.graph.seats[2].landmark, 1U);
  EXPECT_EQ(state.graph.seats[1].landmark, 0U);
  EXPECT_EQ(state.observations[2].landmark, 1U);
  EXPECT_EQ(state.landmarks[0].observations, 2);
  EXPECT_EQ(state.landmarks[0].last_seen_s, 15.0);
  EXPECT_EQ(state.landmarks[1].observations, 1);
  EXPECT_EQ(state.landmarks[1].first_seen_s, 20.0);
  EXPECT_EQ(state.landmarks[1].id, 0U);  // no object until somebody accepts it
}

TEST(Split, AMergeUndoesIt) {
  MapState state = seats_taken_for_one({0.0});
  const std::size_t alone = split(state, 1);
  merge(state, alone, {0, 0, 0.0, 4, 0.0});
  EXPECT_FALSE(state.graph.landmarks[alone].active);
  EXPECT_EQ(state.graph.seats[1].landmark, 0U);
  EXPECT_EQ(state.landmarks[0].observations, 2);
  EXPECT_EQ(state.landmarks[0].last_seen_s, 15.0);
}

TEST(Revise, TakesBackTheVisitThatTheWayContradicts) {
  MapState state = seats_taken_for_one({0.0, 5.0});
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_FALSE(closer.revise(state, [] { return true; })) << "ended early, nothing was tried";
  EXPECT_TRUE(closer.revise(state));
  EXPECT_EQ(state.summary.loop_closures_revoked, 1U);
  ASSERT_EQ(state.graph.landmarks.size(), 2U);
  EXPECT_EQ(state.observations[1].landmark, 0U);
  EXPECT_EQ(state.observations[2].landmark, 1U);
  EXPECT_NE(state.landmarks[1].id, 0U);
  EXPECT_NEAR(state.graph.landmarks[0].x[0], 1.0, 0.01);
  EXPECT_NEAR(state.graph.landmarks[1].x[0], 6.0, 0.01);
  EXPECT_FALSE(closer.revise(state));  // nothing more to take back
}

TEST(Revise, LeavesAVisitThatOnlyDriftKeepsApart) {
  MapState state = seats_taken_for_one({0.05, -0.08});
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_FALSE(closer.revise(state));
  EXPECT_EQ(state.graph.landmarks.size(), 1U);
}

TEST(InOnePlace, AreThingsOfAKindOfWhichOneIsMostlyWithinTheOther) {
  const auto table = [](double x, double y, double heading, double length, double width) {
    return graph::Landmark{.kind = graph::LandmarkKind::Table, .x = {x, y, 0.75, heading, length, width, 0.0}};
  };
  const graph::Landmark desk = table(1.0, 2.0, 0.4, 1.6, 0.8);
  EXPECT_TRUE(in_one_place(desk, desk));
  EXPECT_TRUE(in_one_place(table(1.1, 2.1, 0.4, 0.8, 0.4), desk)) << "a small one within it";
  EXPECT_TRUE(in_one_place(table(1.0, 2.0, 0.4 + 0.5 * std::numbers::pi, 0.8, 1.6), desk))
      << "its axes named otherwise";
  const double s = std::sin(0.4), c = std::cos(0.4);
  EXPECT_FALSE(in_one_place(table(1.0 - 0.8 * s, 2.0 + 0.8 * c, 0.4, 1.6, 0.8), desk)) << "side by side";
  EXPECT_FALSE(in_one_place(table(1.0 + 1.6 * c, 2.0 + 1.6 * s, 0.4, 1.6, 0.8), desk)) << "end to end";

  graph::Landmark seat{.kind = graph::LandmarkKind::Seat, .x = {0.0, 0.0, 0.45, 0.0, 0.0, 0.0, 0.0}}, next = seat;
  EXPECT_FALSE(in_one_place(seat, desk)) << "of another kind";
  next.x[1] = 0.1;
  EXPECT_TRUE(in_one_place(seat, next));
  next.x[1] = 0.5;
  EXPECT_FALSE(in_one_place(seat, next)) << "a row of chairs";

  graph::Landmark screen{.kind = graph::LandmarkKind::Screen, .x = {3.0, 0.0, 1.2, 0.0, 0.6, 0.35, 0.0}},
      other = screen;
  other.x[2] = 1.25;
  EXPECT_TRUE(in_one_place(screen, other));
  other.x[2] = 1.6;
  EXPECT_FALSE(in_one_place(screen, other)) << "one above the other";
  other.x[2] = 1.2, other.x[3] = std::numbers::pi;
  EXPECT_FALSE(in_one_place(screen, other)) << "back to back";
}

TEST(Revise, LeavesTheVisitOfASloppyHandWhereNothingElseCanStand) {
  MapState state = seats_taken_for_one({0.0, 0.0, 0.19});
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  for (graph::SeatFactor& seat : state.graph.seats) seat.sigma_level_m = 0.01, seat.loss = {};  // a hard contradiction
  EXPECT_FALSE(closer.revise(state));
  EXPECT_EQ(state.graph.landmarks.size(), 1U);
}

TEST(Revise, TakesBackTheVisitThatTouchedAnotherStretchOfThePlane) {
  MapState state = wall_touched_along({{0.0, 3.0}, {1.0, 2.0}, {4.0, 6.0}});
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_TRUE(closer.revise(state));
  ASSERT_EQ(state.graph.landmarks.size(), 2U);
  EXPECT_EQ(state.observations[0].landmark, 0U);
  EXPECT_EQ(state.observations[1].landmark, 0U);
  EXPECT_EQ(state.observations[2].landmark, 1U);
}

TEST(Revise, LeavesAWallThatVisitsShareInPart) {
  MapState state = wall_touched_along({{0.0, 3.0}, {2.0, 6.0}});
  LoopCloser closer{MapperConfig{}};
  ASSERT_TRUE(closer.settle(state, 30));
  EXPECT_FALSE(closer.revise(state));
}

}  // namespace
}  // namespace kinemap
