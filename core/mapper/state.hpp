// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/landmarks/extract.hpp"
#include "core/map.hpp"

namespace kinemap {

/// What is known of a landmark beside its numbers in the graph (same index).
struct LandmarkRecord {
  std::uint32_t id = 0;  ///< of the map object; 0 until it is accepted as one of its own
  int observations = 0;
  double first_seen_s = 0.0;
  double last_seen_s = 0.0;
  double floor_z = 0.0;  ///< of the level that it stands on, map frame, m
};

/// What is left of a visit whose factors are folded (graph::FoldedFactor).
struct SettledVisit {
  std::size_t first_pose = 0, last_pose = 0;                   ///< poses of the graph from which it was made
  std::optional<std::array<Eigen::Vector3d, 2>> touched = {};  ///< walls: the ends of what was touched, map frame, m
};

/// One visit to a landmark: its factors in the graph. Poses are indices in the graph, which for a session of hours are
/// not the ids of key poses any more.
struct ObservationRecord {
  std::size_t landmark = 0;
  std::size_t key_pose = 0;       ///< in the middle of the visit
  std::size_t first_contact = 0;  ///< graph.contacts[first_contact, + contacts)
  std::size_t contacts = 0;
  std::size_t seat = 0;  ///< index in graph.seats, for seats
  double begin_s = 0.0;
  double end_s = 0.0;
  std::optional<SettledVisit> settled = {};

  [[nodiscard]] bool has_seat() const { return contacts == 0 && !settled; }
};

/// Everything that a loop closure changes, as one value: a trial works on a copy and is kept or dropped.
struct MapState {
  graph::Graph graph;
  std::vector<LandmarkRecord> landmarks;
  std::vector<ObservationRecord> observations;
  std::optional<std::size_t> direction;  ///< landmark: the heading that walls keep to
  GraphSummary summary;
};

}  // namespace kinemap
