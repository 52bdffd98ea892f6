// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map.hpp"

namespace kinemap::foxglove {

/// One thing of the scene. An entity replaces the one before with the same id.
struct Entity {
  std::string id;       ///< "object/7", "room/1", "doorways": stays the same for as long as the thing exists
  double time_s = 0.0;  ///< since when it is there: an object's first_seen
  std::string json;     ///< foxglove.SceneEntity
};

/// Walls as translucent planes with an outline, tables, screens and seats as cubes, rooms as floors, ways through walls
/// as lines; each with a label, objects with their values as metadata. By ascending id within each kind.
std::vector<Entity> entities(const MapSnapshot& map);

}  // namespace kinemap::foxglove
