// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/map.hpp"

namespace kinemap {

/// The map as one binary glTF 2.0 file (.glb) for any 3-D viewer: walls (translucent, open at the doorways), floors,
/// tables, screens, seats and the optimised trajectory as a line. One node for each object, named "table 3", with the
/// object's map JSON as `extras`. Metres; the geometry is in the map frame (z up) under one root node that turns it to
/// glTF's y up.
std::string glb_bytes(const MapSnapshot& map);

}  // namespace kinemap
