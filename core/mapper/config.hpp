// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/landmarks/config.hpp"

namespace kinemap {

/// Angles in radians, lengths in metres, times in seconds. config/README.md explains each key to users.
struct MapperConfig {
  /// How odometry errs between key poses: variances grow with distance, time and turn (reference: the default column of
  /// suit drift).
  struct Odometry {
    double translation_m_per_sqrt_m = 0.022;  ///< random walk of the level position (1 cm per 20 cm, paper section V)
    double translation_m_per_sqrt_s = 0.003;  ///< the same while standing
    double vertical_m_per_sqrt_m = 0.012;     ///< random walk of the height, false steps included
    double heading_rad_per_sqrt_s = 0.0175;  ///< random walk of the heading; wide, since magnetic errors are correlated
    double heading_rad_per_rad = 0.02;       ///< of each turn
    double tilt_rad = 0.009;                 ///< roll and pitch, observed from gravity at each key pose
    double floor_m = 0.02;                   ///< height of the stance foot over its level
  } odometry;

  /// The right hand as a measuring tip.
  struct Hand {
    double tip_m = 0.0;  ///< wrist to touching point; 0: from the suit's body points, else from the wearer's stature
    double tip_per_stature = 0.105;  ///< finger tip beyond the wrist as a part of the body height
    double tip_sigma_m =
        0.04;  ///< how far the touching point may lie along the hand from there; estimated, 0: taken as it is
    double tip_sideways_sigma_m = 0.015;  ///< the same across the hand
    double contact_sigma_m = 0.03;        ///< of one independent contact: arm chain, jitter, imperfect touch
    double contact_correlation_s = 2.0;   ///< contacts within this time err together and count as one
    double contact_spacing_m = 0.06;      ///< contacts are thinned to this distance before they become factors
    double corner_sigma_m = 0.05;         ///< of the end of an open contour
    double loss_scale = 2.0;              ///< Cauchy, in standard deviations
  } hand;

  struct Seats {
    double level_sigma_m = 0.06;
    double height_sigma_m = 0.03;
    double heading_sigma_rad = 0.15;
    double loss_scale = 2.0;  ///< Cauchy, in standard deviations
  } seats;

  struct Walls {
    double height_m = 2.5;                ///< assumed: a hand does not reach the ceiling
    double right_angle_sigma_rad = 0.03;  ///< soft prior that walls are parallel or at right angles; 0: none
    double right_angle_max_rad = 0.17;    ///< walls farther from a multiple of 90° are oblique and left alone
    double join_max_m = 8.0;              ///< a wall is prolonged at most so far to meet the next
  } walls;

  struct Association {
    double gate_sigma = 4.5;  ///< candidates: Mahalanobis distance of the relative marginal, as a one-dimensional sigma
    double position_sigma_m = 0.08;  ///< what two traces of one object differ by beyond the graph's covariance
    double heading_sigma_rad = 0.06;
    double size_sigma_m = 0.06;
    double size_sigma_per_m = 0.05;
    /// A newcomer farther from a landmark than this is not taken for it, however wide the covariance: another object of
    /// the kind is as likely there. When other closures have taken the drift out, it is looked at again. Tables and
    /// screens have sizes to tell them by.
    double wall_max_shift_m = 1.0;
    double seat_max_shift_m = 0.6;
    double table_max_shift_m = 1.5;
    double screen_max_shift_m = 1.0;
    double max_cost_increase = 30.0;  ///< a closure that costs more (2 × robust cost) than this is taken back
    double ambiguity = 6.0;           ///< two candidates whose costs differ by less wait for more evidence
  } association;

  struct Solver {
    int closure_iterations = 6;  ///< at each loop closure, warm-started
    int final_iterations = 30;   ///< at the end of a recording
  } solver;

  LandmarkConfig landmarks;
};

}  // namespace kinemap
