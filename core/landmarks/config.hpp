// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// What makes a trace an object. Angles in radians, lengths in metres, times in seconds.
struct LandmarkConfig {
  double plane_tolerance_m = 0.07;       ///< contacts farther from the surface are lead-in, lead-out or lift-off
  double plane_tolerance_per_m = 0.012;  ///< more of it for each metre of extent: the odometry bends long traces
  double reach_speed_m_per_s =
      0.5;                   ///< a hand faster than this (and twice its usual speed) at either end is still on its way
  double reach_max_s = 1.5;  ///< longest lead-in or lead-out looked for by speed
  double wall_min_extent_m = 0.4;      ///< first and last contact of a wall are at least so far apart
  double rectangle_min_side_m = 0.15;  ///< shortest side of a table or screen
  double rectangle_max_side_m = 4.0;   ///< longest side of a table or screen
  double corner_window_m = 0.18;       ///< length of the line fits to both sides of a corner (paper, section IV)
  double corner_angle_rad = 0.79;      ///< smallest angle between them at a corner
  double table_min_height_m = 0.3;     ///< level surfaces are tables between these heights over the floor
  double table_max_height_m = 1.4;
  double max_slant_rad = 0.44;  ///< a surface that leans farther from level or upright is kept as unresolved
};

}  // namespace kinemap
