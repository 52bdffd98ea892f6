// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map.hpp"

namespace kinemap {

/// Whether the object stands in the room or, a wall, bounds it.
bool is_in_room(const MapObject& object, const Room& room);

}  // namespace kinemap
