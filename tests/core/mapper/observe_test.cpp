// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/observe.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kinemap {
namespace {

using graph::Edge;
using graph::LandmarkKind;

constexpr double kHeight = 0.75, kTip = 0.17;  // m

/// A hand with its tip at `p`, fingers along +y, pointing down by `down_rad`.
HandContact hand(double time_s, const Eigen::Vector3d& p, double down_rad) {
  HandContact contact;
  contact.time_s = time_s;
  // The hand's fingers point along its −y.
  contact.T_key_hand.q =
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(down_rad, Eigen::Vector3d::UnitX());
  contact.T_key_hand.p = p - contact.T_key_hand.q * Eigen::Vector3d(0.0, -kTip, 0.0);
  return contact;
}

/// One edge of a table, drawn in 10 s from x = −0.8 to 0.8 m; in the first and the last 0.8 s the hand turns.
struct Edgewise {
  Edgewise() {
    state.graph.poses.emplace_back();
    state.graph.touch_points.emplace_back();
    state.graph.touch_points[0].p_hand = {0.0, -kTip, 0.0};
    seen.landmark.kind = LandmarkKind::Table;
    seen.landmark.x = {0.0, 0.4, kHeight, 0.0, 1.6, 0.8, 0.0};
    for (int k = 0; k <= 100; ++k) {
      const double t = 0.1 * k, turn = std::max(0.0, 0.8 - std::min(t, 10.0 - t));
      trace.contacts.push_back(hand(t, {-0.8 + 0.16 * t, 0.0, kHeight}, 0.4 + turn));
      seen.contacts.push_back(static_cast<std::size_t>(k));
      seen.labels.push_back({Edge::MinusV, Edge::None});
    }
  }
  std::size_t add() {
    return add_observation(seen, trace, trace_points(trace, state.graph, 0), 0, 0.0, MapperConfig{}, state);
  }
  MapState state;
  Trace trace;
  Observation seen;
};

TEST(Observe, FingersIntoTheSurface) {
  const Edgewise edge;
  EXPECT_NEAR(fingers_into(edge.seen.landmark, edge.trace.contacts[50], edge.state.graph), std::sin(0.4), 1e-12);
}

TEST(Observe, AHandThatStillTurnsToTheSurfaceSaysNothing) {
  Edgewise edge;
  edge.add();
  const auto& contacts = edge.state.graph.contacts;
  ASSERT_GT(contacts.size(), 15u);
  for (const auto& contact : contacts) {
    const double x = (contact.T_i_hand * edge.state.graph.touch_points[0].p_hand).x();
    EXPECT_LT(std::abs(x), 0.8 - 0.16 * 0.5);
  }
}

TEST(Observe, WhereASideEndsItTellsThat) {
  Edgewise edge;
  edge.seen.labels.back().corner = Edge::PlusU;
  edge.add();
  const auto &end = edge.state.graph.contacts.back(), &before = edge.state.graph.contacts[10];
  EXPECT_EQ(end.corner, Edge::PlusU);
  EXPECT_NEAR((end.T_i_hand * edge.state.graph.touch_points[0].p_hand).x(), 0.8, 1e-9);
  EXPECT_EQ(end.sigma_corner_m, before.sigma_corner_m);
  EXPECT_GT(end.sigma_edge_m, 5.0 * before.sigma_edge_m);
  EXPECT_GT(end.sigma_plane_m, 5.0 * before.sigma_plane_m);
}

}  // namespace
}  // namespace kinemap
