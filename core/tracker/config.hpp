// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// Angles in radians, lengths in metres, times in seconds. config/README.md explains each key to users.
struct TrackerConfig {
  struct KeyPoses {
    double distance_m = 0.2;    ///< level distance since the last key pose (paper, section V)
    double turn_rad = 0.1745;   ///< heading change since the last key pose
    double tracing_s = 1.0;     ///< time since the last key pose while tracing or sitting
    double idle_s = 10.0;       ///< time since the last key pose otherwise
  } key_poses;
};

}  // namespace kinemap
