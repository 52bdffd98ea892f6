// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/map.hpp"
#include "protocol/foxglove/channels.hpp"

namespace kinemap::foxglove {

/// map → odom (the drift corrected so far) → pelvis → the other segments, each relative to the one it hangs on, so that
/// a viewer draws the skeleton. `T_odom_segments` is the whole body in the order of Segment, or only the pelvis.
Message transforms(double time_s, const Pose& T_map_odom, std::span<const Pose> T_odom_segments);

/// The optimised key poses at `map.time_s`; thinned evenly to about `max_poses` (first and last stay), for 0 all.
Message trajectory(const MapSnapshot& map, std::size_t max_poses = 0);

enum class LogLevel : std::uint8_t { Info = 2, Warning = 3, Error = 4 };
Message log(double time_s, LogLevel level, const std::string& text);

}  // namespace kinemap::foxglove
