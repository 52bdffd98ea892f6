// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// One line of a TUM trajectory file.
struct TimedPose {
  double time_s = 0.0;
  Pose pose;
};

/// The key poses as a TUM trajectory, one line each: `t x y z qx qy qz qw`, t in seconds of stream time since the first
/// frame.
std::string tum_text(std::span<const TimedPose> poses);
std::string optimised_tum(const MapSnapshot& map);  ///< T_map_pelvis
std::string odometry_tum(const MapSnapshot& map);   ///< T_odom_pelvis, as the suit gave them

/// Reads a TUM trajectory; empty lines and lines that start with # are skipped. The Error names the line.
Result<std::vector<TimedPose>> tum_from_text(const std::string& text);

}  // namespace kinemap
