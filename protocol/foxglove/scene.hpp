// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/foxglove/channels.hpp"
#include "protocol/foxglove/entities.hpp"

namespace kinemap::foxglove {

/// These entities as they are, deleting none, at that stream time (s).
Message scene(double time_s, std::span<const Entity> entities);

/// The scene from one map to the next, as foxglove.SceneUpdate.
class Scene {
 public:
  /// Takes over the next map and returns what changed since the map before: entities that are new or other than they
  /// were, deletions of what has gone. nullopt when nothing changed.
  std::optional<Message> update(const MapSnapshot& map);
  /// The whole of it for somebody who knows nothing, or not what: deletes all, then adds all.
  [[nodiscard]] Message whole() const;

 private:
  double time_s_ = 0.0;
  std::map<std::string, std::string> entities_;  // id → JSON
};

}  // namespace kinemap::foxglove
