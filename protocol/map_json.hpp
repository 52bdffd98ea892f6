// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// The map as JSON (protocol/README.md, protocol/map.schema.json). Absent means unknown: no null, no −1.
nlohmann::ordered_json to_json(const MapSnapshot& map);
nlohmann::ordered_json to_json(const MapObject& object);
nlohmann::ordered_json to_json(const Room& room);
nlohmann::ordered_json to_json(const Doorway& doorway);
/// {"position": [x, y, z], "orientation": [w, x, y, z]}, rounded, w ≥ 0.
nlohmann::ordered_json to_json(const Pose& pose);
/// A number rounded to a micrometre (microradian, microsecond): far below any sigma, and short to read. No −0.
double rounded(double value);
/// `map.json` as a file has it: two-space indent, a final newline, the same bytes for the same map.
std::string map_text(const MapSnapshot& map);

/// Reads what `map_text` wrote (objects, rooms, revision). The Error names the key path.
Result<MapSnapshot> map_from_text(const std::string& text);

/// Reads the objects of an answer of /api/v1/objects; what else is in it is left alone.
Result<std::vector<MapObject>> objects_from_text(const std::string& text);

}  // namespace kinemap
