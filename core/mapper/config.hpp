// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// Angles in radians, lengths in metres, times in seconds. config/README.md explains each key to users.
struct MapperConfig {
  struct Odometry {
    double translation_m_per_sqrt_m = 0.022;   ///< random walk of the level position (1 cm per 20 cm, paper section V)
    double heading_rad_per_sqrt_s = 0.0175;    ///< random walk of the heading; wide, since magnetic errors are correlated
  } odometry;
};

}  // namespace kinemap
