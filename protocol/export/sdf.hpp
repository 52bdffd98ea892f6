// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/map.hpp"

namespace kinemap {

/// The map as a world for Gazebo and whatever else reads SDFormat 1.7: one static model for each object ("table_3"), of
/// boxes with visual and collision; walls open at the doorways, the inferred walls of rooms closed; the ground at the
/// lowest floor, and a sun. Metres, the map frame (z up). Legs, back rests and thicknesses are made up.
std::string world_sdf(const MapSnapshot& map);

}  // namespace kinemap
