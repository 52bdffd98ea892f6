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
    /// As standing feet see it (KeyPose::slip), beside the suit's own: two measurements.
    double feet_m_per_sqrt_m = 0.02;
    double feet_rad_per_sqrt_s = 0.012;
    double vertical_m_per_sqrt_m = 0.012;  ///< random walk of the height, false steps included
    /// The heading's passing error is drawn by noise and comes back by itself; harder beside metal, where the compass
    /// draws it to a wrong north: while a table or screen is traced (or the suit says that the field is wrong) and for
    /// some time after it.
    double heading_rad_per_sqrt_s = 0.02;
    double magnetic_rad_per_sqrt_s = 0.07;
    double magnetic_after_s = 8.0;
    double heading_return_s = 20.0;        ///< time constant of coming back
    double heading_rad_per_rad = 0.02;     ///< of each turn
    double north_sigma_rad = 0.1;          ///< passing error that a session may begin with
    double north_rate_rad_per_s = 0.0015;  ///< the suit's north turns at a constant rate, about so fast (5 °/min)
    double north_rad_per_sqrt_s = 0.0175;  ///< and wanders so
    /// Of the length of steps, constant for a wearer: no closure sees it (a closed loop scales to a closed loop), so
    /// that it only widens what is published of lengths and places.
    double scale_sigma = 0.02;
    double tilt_rad = 0.009;  ///< roll and pitch, observed from gravity at each key pose
    double floor_m = 0.02;    ///< height of the stance foot over its level
  } odometry;

  /// The right hand as a measuring tip.
  struct Hand {
    double tip_m = 0.0;  ///< wrist to touching point; 0: from the suit's body points, else from the wearer's stature
    double tip_per_stature = 0.105;       ///< finger tip beyond the wrist as a part of the body height
    double tip_thickness_m = 0.01;        ///< from the hand's axis to the pads of the fingers
    double tip_sigma_m = 0.025;           ///< how far from there fingers touch, along the hand; 0: taken as it is
    double body_point_sigma_m = 0.02;     ///< the same where the suit's body points or `tip_m` say where the tip is
    double tip_sideways_sigma_m = 0.015;  ///< the same across the hand
    double palm_share = 0.25;             ///< of the wearers who touch with the flat palm; 0: nobody does
    double palm_per_stature = 0.0525;     ///< middle of the palm beyond the wrist as a part of the body height
    double palm_thickness_m = 0.02;       ///< from the hand's axis to the palm
    double palm_sigma_m = 0.02;           ///< how far from there palms touch, along the hand
    double turn_noise_rad_per_m = 2.4;    ///< noise of the hand's orientation over that of the wrist's position: three
                                          ///< joints that err alike, √3 / 0.72 m
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
    double height_m = 2.5;  ///< assumed: a hand does not reach the ceiling
    double right_angle_sigma_rad =
        0.02;                     ///< walls keep so well to the building's direction (mod 90°); 0: no such prior
    double oblique_share = 0.05;  ///< part of all walls that keep to no right angle; they are left alone
    double join_max_m = 8.0;      ///< a wall is prolonged at most so far to meet the next
  } walls;

  struct Association {
    /// How good this suit, its wearer and the building's metal are is not known when the first loops close, and a
    /// covariance that is too narrow refuses those that matter most. So all sigmas of a difference are taken so many
    /// times wider than the graph says.
    double doubt = 2.0;
    double gate_sigma = 3.5;  ///< candidates: Mahalanobis distance of that difference, as a one-dimensional sigma
    double position_sigma_m = 0.08;  ///< what two traces of one object differ by beyond the graph's covariance
    double heading_sigma_rad = 0.06;
    double size_sigma_m = 0.06;
    double size_sigma_per_m = 0.05;
    /// How many objects that look the same are expected elsewhere: the newcomer may be another one. Against this the
    /// hypothesis that it is the known one has to win, so the gate closes as the drift between both grows.
    double wall_density_per_m = 0.15;
    double table_density_per_m2 = 0.08;
    double screen_density_per_m2 = 0.08;
    double seat_density_per_m2 = 0.3;
    double look_alike_share = 0.5;  ///< part of them that also have the same size, height and heading
    double neighbour_share = 0.2;   ///< tables and screens: on each side one like it stands flush beside it so often
    double min_evidence = 0.0;      ///< 2 ln of the odds that it is the known one, to close a loop
    double joint_evidence = 0.0;    ///< less by itself: not tried for the sake of others that it
                                    ///< bears out
    double free_space_most = 12.0;  ///< 2 ln of the odds that one thing standing, or walked, through another may count
                                    ///< for or against a closure; 0: it does not
    double max_cost_increase = 30.0;  ///< a closure that costs more (2 × robust cost) than this is taken back
    double min_relief = 20.0;  ///< a visit is taken off its object when the optimum without it costs so much less
    double ambiguity = 4.0;    ///< two candidates whose costs differ by less wait for more evidence
  } association;

  struct Solver {
    int closure_iterations = 6;  ///< at each loop closure, warm-started
    int final_iterations = 30;   ///< at the end of a recording
    /// In a session of hours, once so many key poses are free to move, those before the last `kept_free_key_poses`
    /// settle as far as their places are known (core/mapper/settled.hpp).
    int most_free_key_poses = 4500;
    int kept_free_key_poses = 3000;
  } solver;

  LandmarkConfig landmarks;
};

}  // namespace kinemap
