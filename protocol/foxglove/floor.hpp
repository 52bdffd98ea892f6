// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map.hpp"
#include "protocol/foxglove/channels.hpp"

namespace kinemap::foxglove {

/// The free floor: where the wearer walked, in cells of 10 cm, as foxglove.Grid with the fields red, green, blue,
/// alpha: what was not walked is transparent.
Message floor(const MapSnapshot& map);

}  // namespace kinemap::foxglove
