// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/map.hpp"

namespace kinemap::cli {

/// Turns the messages of /api/v1/stream into lines for people: what is new, changed or gone since the map before.
class News {
 public:
  /// The lines for one message (a JSON text), "" when there is nothing to say about it.
  std::string lines(const std::string& message);

 private:
  std::string map_lines(const MapSnapshot& map);

  nlohmann::ordered_json map_;  ///< as the messages up to now have it
  std::map<std::uint32_t, MapObject> known_;
};

}  // namespace kinemap::cli
