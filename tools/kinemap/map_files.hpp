// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/map.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// What `kinemap build` leaves in its output directory: every file of protocol/export/exports.hpp. Each is replaced as
/// a whole; map.json comes last, so that a map is never newer than its companions.
std::optional<Error> write_map_files(const std::string& directory, const MapSnapshot& map);

/// Reads map.json, and the trajectory from the .tum files beside it when they are there, back into a snapshot.
/// `path` is the directory or the map.json itself.
Result<MapSnapshot> read_map_files(const std::string& path);

}  // namespace kinemap::cli
