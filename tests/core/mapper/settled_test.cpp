// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/settled.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/landmarks/contours.hpp"
#include "tests/core/mapper/wearer.hpp"

namespace kinemap {
namespace {

/// A way of so many steps, its first pose certain; every so many poses a place is known to 5 cm, up to pose `known`.
graph::Graph way(std::size_t poses, std::size_t known) {
  graph::Graph graph;
  graph::Matrix6 step = graph::Matrix6::Identity();
  step.diagonal() << 50.0, 50.0, 50.0, 100.0, 100.0, 100.0;
  for (std::size_t i = 0; i < poses; ++i) {
    graph.poses.push_back(level_pose({0.2 * static_cast<double>(i), 0.0, 0.0}, 0.0));
    if (i > 0) graph.between.push_back({i - 1, i, level_pose({0.2, 0.0, 0.0}, 0.0), step, {}});
    if (i % 20 == 0 && i < known) graph.priors.push_back({i, graph.poses[i], graph::Matrix6::Identity() * 20.0});
  }
  return graph;
}

std::size_t first_unsettled(const graph::Graph& graph) {
  const auto marginals = graph::Marginals::compute(graph);
  EXPECT_TRUE(marginals);
  MapState state;
  state.graph = graph;
  return marginals ? first_unsettled_pose(state, *marginals, {}) : 0;
}

TEST(Settled, NothingInASessionOfHalfAnHour) { EXPECT_EQ(first_unsettled(way(4400, 4400)), 0u); }

TEST(Settled, WhatIsWellKnownAndLongAgo) {
  auto graph = way(5000, 5000);
  const std::size_t settled = first_unsettled(graph);
  EXPECT_GT(settled, 1900u);
  EXPECT_LE(settled, 2000u);
  graph.first_free_pose = settled;
  EXPECT_EQ(first_unsettled(graph), settled) << "in steps";
}

TEST(Settled, NotWhatNoClosureHasTiedDown) {
  const std::size_t settled = first_unsettled(way(5000, 1000));
  EXPECT_GT(settled, 900u);
  EXPECT_LT(settled, 1500u);
}

TEST(Settled, NoVisitIsCutInTwo) {
  MapState state;
  state.graph = way(5000, 5000);
  state.graph.landmarks.resize(1);
  for (const std::size_t first : {900u, 1890u}) {
    ObservationRecord visit;
    visit.key_pose = first + 30, visit.first_contact = state.graph.contacts.size(), visit.contacts = 60;
    state.observations.push_back(visit);
    for (std::size_t k = 0; k < 60; ++k)
      state.graph.contacts.push_back({.i = first + 2 * k, .T_i_hand = {}, .loss = {}});
  }
  const auto marginals = graph::Marginals::compute(way(5000, 5000));
  ASSERT_TRUE(marginals);
  EXPECT_EQ(first_unsettled_pose(state, *marginals, {}), 1890u);
}

std::vector<TrajectoryPose> straight_on(int poses) {
  std::vector<TrajectoryPose> way;
  for (int k = 0; k < poses; ++k) {
    const Pose T = level_pose({0.2 * k, 0.0, 0.9}, 0.0);
    way.push_back({static_cast<KeyPoseId>(k), 0.2 * k, T, T, {0.03, 0.04, 0.001, 0.02}});
  }
  return way;
}

TEST(SettledWay, OfAStraightOneItsEndsAndWhatIsWanted) {
  const auto way = straight_on(100);
  EXPECT_EQ(poses_to_keep(way, {}), (std::vector<std::size_t>{0, 99}));
  EXPECT_EQ(poses_to_keep(way, {17, 50}), (std::vector<std::size_t>{0, 17, 50, 99}));
}

TEST(SettledWay, WhatIsLeftOutIsFoundBetween) {
  auto way = straight_on(400);
  for (std::size_t k = 0; k < way.size(); ++k) {
    Pose& T = way[k].T_map_pelvis;
    T = level_pose({T.p.x(), std::sin(0.08 * static_cast<double>(k)), 0.9}, std::cos(0.08 * static_cast<double>(k)));
  }
  const auto kept = poses_to_keep(way, {});
  EXPECT_LT(kept.size(), 130u);
  for (std::size_t n = 1; n < kept.size(); ++n) {
    const TrajectoryPose &a = way[kept[n - 1]], &b = way[kept[n]];
    for (std::size_t k = kept[n - 1] + 1; k < kept[n]; ++k) {
      const double t = (way[k].time_s - a.time_s) / (b.time_s - a.time_s);
      const Eigen::Vector3d between = (1.0 - t) * a.T_map_pelvis.p + t * b.T_map_pelvis.p;
      EXPECT_LT((way[k].T_map_pelvis.p - between).norm(), 0.08);
    }
  }
}

TEST(SettledWay, TheNoiseOfItsStepsAddsUp) {
  const auto way = thinned(straight_on(10), {0, 4, 9});
  ASSERT_EQ(way.size(), 3u);
  EXPECT_EQ(way[1].id, 4u);
  EXPECT_NEAR(way[1].step.level_m, 0.06, 1e-12);
  EXPECT_NEAR(way[2].step.up_m, 0.04 * std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(way[2].step.heading_rad, 0.02 * std::sqrt(5.0), 1e-12);
}

/// Rounds through a 6 × 4 m room: its walls, a table, a chair.
std::vector<Event> rounds(int n) {
  test::Wearer wearer(0.0006);
  const auto wall = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    wearer.walk_to(0.7 * a.x() + 0.6, 0.7 * a.y() + 0.3);
    wearer.trace({{a.x(), a.y(), 1.1}, {b.x(), b.y(), 1.3}}, {2.0, 1.0});
  };
  for (int round = 0; round < n; ++round) {
    wall({-0.5, -1.0}, {4.5, -1.0});
    wearer.walk_to(3.0, 0.0);
    auto corners = test::level_rectangle({3.0, 1.5, 0.74}, 0.0, 1.4, 0.8);
    corners.push_back(corners.front());
    wearer.trace(corners, {3.0, -3.5});
    wall({5.0, -0.5}, {5.0, 2.5});
    wall({4.5, 3.0}, {-0.5, 3.0});
    wearer.sit(0.5, 2.0, -1.0);
    wall({-1.0, 2.5}, {-1.0, -0.5});
  }
  return wearer.events;
}

struct Session {
  std::shared_ptr<const MapSnapshot> map;
  graph::Graph graph;
};

MapperConfig long_day(int most_free) {
  MapperConfig config;
  config.hand.tip_m = 0.18;
  config.solver.most_free_key_poses = most_free;
  config.solver.kept_free_key_poses = 2 * most_free / 3;
  return config;
}

Session mapped(const std::vector<Event>& events, int most_free) {
  Mapper mapper(long_day(most_free));
  for (const Event& event : events) mapper.add(event);
  mapper.finish();
  return {mapper.snapshot(), mapper.graph()};
}

/// Five rounds, of which nothing settles, and of which most does.
const Session& all_free() {
  static const Session session = mapped(rounds(5), 100000);
  return session;
}
const Session& mostly_settled() {
  static const Session session = mapped(rounds(5), 300);
  return session;
}

TEST(LongDay, TheMapIsTheSame) {
  const auto all = all_free().map, map = mostly_settled().map;
  ASSERT_LT(map->trajectory.size(), all->trajectory.size());
  EXPECT_EQ(map->graph.key_poses, all->graph.key_poses);
  EXPECT_EQ(map->graph.contacts, all->graph.contacts);
  EXPECT_EQ(map->graph.loop_closures, all->graph.loop_closures);
  ASSERT_EQ(map->objects.size(), all->objects.size());
  for (std::size_t k = 0; k < map->objects.size(); ++k) {
    const MapObject &a = map->objects[k], &b = all->objects[k];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.observations, b.observations);
    EXPECT_EQ(a.visits.size(), b.visits.size());
    EXPECT_LT((a.pose.p - b.pose.p).norm(), 0.02) << a.id;
    ASSERT_EQ(a.size.has_value(), b.size.has_value());
    if (a.size) {
      EXPECT_NEAR((*a.size)[0], (*b.size)[0], 0.02) << a.id;
    }
  }
  ASSERT_EQ(map->rooms.size(), 1u);
  ASSERT_EQ(all->rooms.size(), 1u);
  EXPECT_NEAR(map->rooms[0].area_m2, all->rooms[0].area_m2, 0.2);
}

TEST(LongDay, GoesOnFromACheckpointAsIfNothingHadHappened) {
  const auto events = rounds(5);
  MapperConfig config = long_day(300);
  Mapper mapper(config);
  std::size_t next = 0;
  while (!std::holds_alternative<Trace>(events[next]) || mapper.snapshot()->time_s < 250.0) mapper.add(events[next++]);
  mapper.add(events[next++]);
  ASSERT_FALSE(mapper.graph().folded.empty());
  const std::string checkpoint = mapper.checkpoint();
  auto restored = Mapper::restore(config, checkpoint);
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->snapshot()->revision, mapper.snapshot()->revision);
  EXPECT_EQ(restored->snapshot()->objects.size(), mapper.snapshot()->objects.size());
  EXPECT_EQ(restored->snapshot()->trajectory.size(), mapper.snapshot()->trajectory.size());
  for (; next < events.size(); ++next) restored->add(events[next]);
  restored->finish();
  const auto a = restored->snapshot(), b = mostly_settled().map;
  ASSERT_EQ(a->objects.size(), b->objects.size());
  for (std::size_t k = 0; k < a->objects.size(); ++k) {
    EXPECT_EQ(a->objects[k].pose.p, b->objects[k].pose.p);
    EXPECT_EQ(a->objects[k].size, b->objects[k].size);
  }
  EXPECT_EQ(a->trajectory.back().T_map_pelvis.p, b->trajectory.back().T_map_pelvis.p);
  EXPECT_EQ(a->graph.loop_closures, b->graph.loop_closures);

  EXPECT_FALSE(Mapper::restore(config, std::string_view(checkpoint).substr(0, checkpoint.size() - 1)));
  EXPECT_FALSE(Mapper::restore(config, checkpoint + "x"));
  EXPECT_FALSE(Mapper::restore(config, "no checkpoint"));
  std::string older = checkpoint;
  --older[0];  // the version
  EXPECT_FALSE(Mapper::restore(config, older));
  for (std::size_t cut = 0; cut < checkpoint.size(); cut += 1009)
    EXPECT_FALSE(Mapper::restore(config, std::string_view(checkpoint).substr(0, cut)));
}

TEST(LongDay, TheGraphDoesNotGrowWithIt) {
  const graph::Graph one = mostly_settled().graph, more = mapped(rounds(8), 300).graph;
  EXPECT_LT(more.between.size(), one.between.size() + 200);
  EXPECT_LT(more.contacts.size(), one.contacts.size() + 300);
  EXPECT_LT(more.seats.size(), 4u);
  EXPECT_EQ(more.folded.size(), 6u) << "one for each object";
}

TEST(LongDay, TheTrajectoryHasItsIdsAndTimes) {
  const auto all = all_free().map, map = mostly_settled().map;
  EXPECT_EQ(map->trajectory.front().id, 0u);
  EXPECT_EQ(map->trajectory.back().id, all->trajectory.back().id);
  for (std::size_t k = 0; k < map->trajectory.size(); ++k) {
    const TrajectoryPose& pose = map->trajectory[k];
    if (k > 0) {
      ASSERT_GT(pose.id, map->trajectory[k - 1].id);
      EXPECT_GT(pose.step.level_m, 0.0);
    }
    EXPECT_EQ(pose.time_s, all->trajectory[pose.id].time_s);
    EXPECT_EQ(pose.T_odom_pelvis.p, all->trajectory[pose.id].T_odom_pelvis.p);
    EXPECT_LT((pose.T_map_pelvis.p - all->trajectory[pose.id].T_map_pelvis.p).norm(), 0.08) << pose.id;
  }
}

}  // namespace
}  // namespace kinemap
