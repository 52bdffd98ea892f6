// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/reassign.hpp"

#include <array>
#include <span>
#include <vector>

namespace kinemap {
namespace {

using graph::ContactFactor;
using graph::Edge;
using graph::LandmarkKind;

constexpr double kTravelWindow = 0.09;  // m: contacts of a visit are some centimetres apart
constexpr std::size_t kFollowed = 3;    // contacts on a side that was really followed
constexpr std::array<bool, 4> kAll{true, true, true, true};

std::vector<SideQuery> queries(std::span<const ContactFactor> contacts, const graph::Graph& graph,
                               const Pose& T_rectangle_map) {
  std::vector<Eigen::Vector2d> at;
  for (const ContactFactor& contact : contacts) {
    const Eigen::Vector3d p_map =
        graph.poses[contact.i] * (contact.T_i_hand * graph.touch_points[contact.touch].p_hand);
    at.emplace_back((T_rectangle_map * p_map).head<2>());
  }
  const auto travel = travel_directions(at, kTravelWindow);
  std::vector<SideQuery> out;
  for (std::size_t k = 0; k < contacts.size(); ++k) out.push_back({at[k], travel[k], contacts[k].edge});
  return out;
}

bool crossing(Edge a, Edge b) {
  const auto is_u = [](Edge e) { return e == Edge::MinusU || e == Edge::PlusU; };
  return a != Edge::None && b != Edge::None && is_u(a) != is_u(b);
}

std::size_t reassign(std::span<ContactFactor> contacts, const graph::Graph& graph, const graph::Landmark& landmark,
                     const SideCosts& costs) {
  const std::array<double, 2> size{landmark.x[4], landmark.x[5]};
  const auto asked = queries(contacts, graph, landmark_pose(landmark).inverse());
  const auto sides = choose_sides(asked, size, kAll, costs, true);
  // What lies in a corner says nothing of a side, and no more that the side was followed: else an open end would lose
  // its one contact to a side that keeps none.
  std::vector<Edge> clear = sides;
  std::array<std::size_t, 5> followed{};
  for (std::size_t k = 0; k < clear.size(); ++k) {
    if (clear[k] != Edge::None && in_corner(asked[k].p, size, kAll, clear[k], costs)) clear[k] = Edge::None;
    if (clear[k] != Edge::None) ++followed[static_cast<std::size_t>(clear[k])];
  }
  std::size_t changed = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    ContactFactor& contact = contacts[k];
    Edge edge = sides[k], corner = contact.corner;
    if (followed[static_cast<std::size_t>(corner)] >= kFollowed) corner = Edge::None;
    // The end of an open contour holds the length of the side: it stays on its side even where it strayed.
    if (corner != Edge::None && !crossing(edge, corner)) edge = contact.edge;
    if (corner == Edge::None) edge = clear[k];
    if (edge == contact.edge && corner == contact.corner) continue;
    contact.edge = edge, contact.corner = corner;
    ++changed;
  }
  return changed;
}

}  // namespace

std::size_t reassign_edges(MapState& state, const SideCosts& costs) {
  std::size_t changed = 0;
  for (const ObservationRecord& visit : state.observations) {
    const graph::Landmark& landmark = state.graph.landmarks[visit.landmark];
    const bool rectangle = landmark.kind == LandmarkKind::Table || landmark.kind == LandmarkKind::Screen;
    if (!landmark.active || !rectangle || visit.contacts == 0) continue;
    changed += reassign(std::span(state.graph.contacts).subspan(visit.first_contact, visit.contacts), state.graph,
                        landmark, costs);
  }
  return changed;
}

}  // namespace kinemap
