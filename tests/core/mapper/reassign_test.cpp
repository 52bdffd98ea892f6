// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/reassign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace kinemap {
namespace {

using graph::ContactFactor;
using graph::Edge;

constexpr double kLength = 1.6, kWidth = 0.8, kSpacing = 0.06;

/// A table at (2, 1), turned by 0.4 rad, and one visit that went round `corners` of it (counter-clockwise from −u, −v),
/// each contact with the side that it really lies on.
MapState visit(const std::vector<int>& corners) {
  const std::array<Eigen::Vector2d, 4> at{Eigen::Vector2d(-kLength / 2, -kWidth / 2),
                                          {kLength / 2, -kWidth / 2},
                                          {kLength / 2, kWidth / 2},
                                          {-kLength / 2, kWidth / 2}};
  constexpr std::array<Edge, 4> sides{Edge::MinusV, Edge::PlusU, Edge::PlusV, Edge::MinusU};
  MapState state;
  graph::Landmark table;
  table.kind = graph::LandmarkKind::Table;
  table.x = {2.0, 1.0, 0.74, 0.4, kLength, kWidth, 0.0};
  state.graph.landmarks = {table};
  state.graph.poses = {level_pose({1.0, 1.0, 0.9}, 0.2)};
  state.graph.touch_points.resize(1);
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const auto a = static_cast<std::size_t>(corners[k - 1]), b = static_cast<std::size_t>(corners[k]);
    const Eigen::Vector2d leg = at[b] - at[a];
    for (double s = 0.0; s < leg.norm(); s += kSpacing) {
      const Eigen::Vector2d p = at[a] + s * leg.normalized();
      ContactFactor contact;
      contact.edge = sides[(a + 1) % 4 == b ? a : b];
      contact.T_i_hand.p = state.graph.poses[0].inverse() * (landmark_pose(table) * Eigen::Vector3d(p.x(), p.y(), 0.0));
      state.graph.contacts.push_back(contact);
    }
  }
  ObservationRecord record;
  record.contacts = state.graph.contacts.size();
  state.observations = {record};
  return state;
}

/// The heading is drawn away while the contour is drawn: contacts turn about the pelvis, more and more.
void bend(MapState& state, double rad) {
  auto& contacts = state.graph.contacts;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(contacts.size()) - 0.5;
    contacts[k].T_i_hand.p = Eigen::AngleAxisd(rad * part, Eigen::Vector3d::UnitZ()) * contacts[k].T_i_hand.p;
  }
}

std::vector<Edge> edges(const MapState& state) {
  std::vector<Edge> out;
  for (const auto& contact : state.graph.contacts) out.push_back(contact.edge);
  return out;
}

/// Contacts whose side is not `truth`; those on no side (corners) do not count.
std::size_t wrong(const MapState& state, const std::vector<Edge>& truth) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < truth.size(); ++k)
    n += state.graph.contacts[k].edge != Edge::None && state.graph.contacts[k].edge != truth[k];
  return n;
}

std::size_t on_a_side(const MapState& state) {
  const auto all = edges(state);
  return all.size() - static_cast<std::size_t>(std::count(all.begin(), all.end(), Edge::None));
}

TEST(ReassignEdges, MendsABentContourWhoseSidesWereWrong) {
  for (const double rad : {0.0, 0.25, -0.25}) {
    for (const auto& way : {std::vector{0, 1, 2, 3, 0}, std::vector{2, 1, 0, 3, 2}}) {
      MapState state = visit(way);
      const auto truth = edges(state);
      bend(state, rad);
      for (std::size_t k = 0; k < truth.size(); ++k) {
        if (truth[k] == Edge::PlusU) state.graph.contacts[k].edge = Edge::PlusV;  // a side taken for the next
        if (truth[k] == Edge::MinusV) state.graph.contacts[k].edge = Edge::None;  // a side overlooked
        if (truth[k] == Edge::MinusU && k % 2 == 0) state.graph.contacts[k].edge = Edge::PlusU;  // for the opposite one
      }
      EXPECT_GT(reassign_edges(state), truth.size() / 3);
      EXPECT_LE(wrong(state, truth), rad == 0.0 ? 0u : 2u) << "bent by " << rad;
      EXPECT_GT(on_a_side(state), truth.size() * 8 / 10);
      EXPECT_EQ(reassign_edges(state), 0u) << "settled";
    }
  }
}

TEST(ReassignEdges, CornersSpeakOfThePlaneOnly) {
  MapState state = visit({0, 1, 2, 3, 0});
  reassign_edges(state);
  const Pose T_table_map = landmark_pose(state.graph.landmarks[0]).inverse();
  for (const auto& contact : state.graph.contacts) {
    const Eigen::Vector3d p = T_table_map * (state.graph.poses[0] * contact.T_i_hand.p);
    const double to_corner = std::hypot(std::abs(p.x()) - kLength / 2, std::abs(p.y()) - kWidth / 2);
    EXPECT_EQ(contact.edge == Edge::None, to_corner < 0.04) << p.transpose();
  }
}

TEST(ReassignEdges, AContactThatStrayedIsLeftOutUntilItIsBack) {
  MapState state = visit({0, 1, 2, 3, 0});
  const auto truth = edges(state);
  auto& contact = state.graph.contacts[10];
  const Pose there = contact.T_i_hand;
  contact.T_i_hand.p += Eigen::Vector3d(0.5, 0.5, 0.0);
  reassign_edges(state);
  EXPECT_EQ(contact.edge, Edge::None);
  contact.T_i_hand = there;
  reassign_edges(state);
  EXPECT_EQ(contact.edge, truth[10]);
}

TEST(ReassignEdges, TheEndOfAnOpenContourKeepsItsCorner) {
  MapState state = visit({0, 1, 2});
  state.graph.contacts.front().corner = Edge::MinusU;
  state.graph.contacts.back().corner = Edge::PlusV;
  bend(state, 0.2);
  reassign_edges(state);
  EXPECT_EQ(state.graph.contacts.front().edge, Edge::MinusV);
  EXPECT_EQ(state.graph.contacts.front().corner, Edge::MinusU);
  EXPECT_EQ(state.graph.contacts.back().edge, Edge::PlusU);
  EXPECT_EQ(state.graph.contacts.back().corner, Edge::PlusV);
}

TEST(ReassignEdges, ACornerOfASideThatIsFollowedIsNone) {
  MapState state = visit({0, 1, 2, 3});
  state.graph.contacts.front().corner = Edge::PlusU;  // but the visit goes on along +u
  reassign_edges(state);
  EXPECT_EQ(state.graph.contacts.front().corner, Edge::None);
}

TEST(ReassignEdges, WallsAndWhatIsInactiveAreLeftAlone) {
  MapState state = visit({0, 1, 2, 3, 0});
  for (auto& contact : state.graph.contacts) contact.edge = Edge::MinusU;
  MapState wall = state;
  wall.graph.landmarks[0].kind = graph::LandmarkKind::Wall;
  EXPECT_EQ(reassign_edges(wall), 0u);
  state.graph.landmarks[0].active = false;
  EXPECT_EQ(reassign_edges(state), 0u);
}

}  // namespace
}  // namespace kinemap
