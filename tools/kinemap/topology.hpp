// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "tools/kinemap/association.hpp"
#include "tools/kinemap/truth.hpp"

namespace kinemap::eval {

/// Is the map right but for its measures? It is when every object touched is there once and made of its own visits
/// only, and every room all of whose walls were touched is there with these walls, each next to its neighbours. Objects
/// are known by their visits, not by where they are, so that a bent map may still be right.
struct TopologyCheck {
  std::size_t rooms = 0;           ///< true ones all of whose walls were touched
  std::size_t rooms_found = 0;     ///< of those, with the right walls in the right order
  std::vector<std::string> wrong;  ///< what is not right, for people
  [[nodiscard]] bool right() const { return wrong.empty(); }
};

/// The walls round a true room in the order of its corners, by id; nullopt where one was never touched.
std::vector<std::optional<std::uint32_t>> touched_walls(const Truth& truth, std::size_t room);

/// How many of a true wall's two neighbours were never touched: nobody can see where it ends there.
std::size_t unknown_ends(const Truth& truth, std::uint32_t wall);

TopologyCheck check_topology(const MapSnapshot& map, const Truth& truth, const AssociationCheck& association);

}  // namespace kinemap::eval
