// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "core/map.hpp"

namespace kinemap::cli {

/// The objects as lines of text for people: id, type, size, centre, heading, uncertainty, observations, functions; and
/// the `distances` (m), when there is one for each.
std::string object_table(std::span<const MapObject> objects, std::span<const double> distances = {});

/// One line: "12 objects: 4 walls, 2 tables, …; 1 room of 33.9 m²".
std::string object_counts(const MapSnapshot& map);

}  // namespace kinemap::cli
