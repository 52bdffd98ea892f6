// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace kinemap {

/// Angles in radians, lengths in metres, times in seconds. config/README.md explains each key to users.
/// A pair *_on / *_off is a hysteresis: the state begins at *_on and lasts until *_off. Everything is judged by stream
/// time, never by counting frames. "Share" is a part of a length of the wearer's own body, so that it holds for every
/// stature.
struct TrackerConfig {
  struct KeyPoses {
    double distance_m = 0.2;    ///< level distance since the last key pose (paper, section V)
    double turn_rad = 0.1745;   ///< heading change since the last key pose
    double tracing_s = 1.0;     ///< time since the last key pose while tracing or sitting
    double idle_s = 10.0;       ///< time since the last key pose otherwise
    double path_step_m = 0.02;  ///< the path is summed in such steps, so that neither noise nor frame rate lengthens it
    double turn_step_rad = 0.0175;  ///< the same for the sum of heading changes
  } key_poses;

  /// Which foot carries the weight, and how far the floor is under it.
  struct Stance {
    double rest_speed_mps = 0.35;  ///< an ankle slower than this rests
    double smoothing_s = 0.03;     ///< time constant of the ankle's speed
    double rest_s = 0.06;          ///< it must have rested for so long; a jump's apex is shorter
    double flat_rad = 0.35;       ///< a foot pitched or rolled more than this is rolling off, its sole is not the floor
    double ball_height_m = 0.02;  ///< the ball of the foot (origin of the toe segment) over the sole
    double level_m = 0.015;       ///< soles closer in height are equal: the foot that carried the weight still does
  } stance;

  /// Standing feet, by which the suit's own slipping shows.
  struct Slip {
    double speed_mps = 0.12;      ///< ankle and ball of a standing foot are slower than this
    double turn_rad_per_s = 0.1;  ///< and it turns more slowly than this
    double settle_s = 0.3;        ///< it has stood for so long before it is heard
    double held_m = 0.0015;  ///< a suit whose standing feet move less than this in a second holds them in place, and
                             ///< they say nothing; 100: no suit is heard
  } slip;

  /// Whether metal bends the magnetic field at the pelvis (when the suit streams it): against what is usual in this
  /// recording.
  struct Magnetic {
    double norm_on = 0.10;  ///< strength, part of the usual one
    double norm_off = 0.07;
    double dip_on_rad = 0.10;
    double dip_off_rad = 0.07;
    double smoothing_s = 0.3;      ///< time constant of strength and dip
    double gap_s = 1.0;            ///< without the field for so long nothing is said of it
    double place_m = 0.5;          ///< the usual field is a median over places so far apart …
    std::size_t min_places = 10;   ///< … known after so many of them …
    std::size_t max_places = 200;  ///< … and from the latest of them only
  } magnetic;

  /// Left hand on the hip: the wearer's word that the right hand shows something.
  struct Gesture {
    double elbow_on_rad = 2.09;  ///< inner angle between upper arm and forearm
    double elbow_off_rad = 2.8;
    double hip_on_m = 0.16;  ///< wrist, palm or finger to the iliac crest
    double hip_off_m = 0.28;
    double crest_up_m = 0.10;   ///< iliac crest over the hip joint, in the pelvis frame
    double crest_out_m = 0.06;  ///< iliac crest outside the hip joint, in the pelvis frame
    // The finger tips may be so far below the hip joint; lower is a pocket or a hanging arm.
    double below_hip_on_m = 0.10;
    double below_hip_off_m = 0.14;
    // Wrist or palm must be so far outside of the hip joint; less is the belly or the lap.
    double outside_hip_on_m = 0.01;
    double outside_hip_off_m = -0.05;
    double rest_speed_mps = 0.18;  ///< of the wrist against the pelvis, to begin; swinging and scratching are faster
    double hold_s = 0.5;           ///< the hand must rest for so long; a trace still begins when it came near
    // The right hand on its own hip ends it. It draws beside the hip too, so its palm must lie there, and for so long.
    double both_hip_m = 0.15;  ///< middle of the palm to the iliac crest
    double both_hold_s = 2.0;
    // So does the right arm when it hangs: while one walks it goes to and fro beside the body, where one stands it
    // rests.
    double walk_speed_mps = 0.55;        ///< of the pelvis, over a second
    double swing_m = 0.08;               ///< of the wrist forward and back, from the one to the other; 100: none swings
    double swing_hold_s = 0.6;           ///< for so long
    double rest_m = 0.04;                ///< pelvis, and wrist against it, move less than this; 0: no arm rests
    double rest_hold_s = 0.8;            ///< for so long
    double hang_before_hip_m = 0.17;     ///< the resting wrist before or behind the hip joint: one that stoops draws
    double hang_rad = 0.35;              ///< from shoulder to wrist, against the plumb line
    double hang_elbow_rad = 2.4;         ///< inner angle between upper arm and forearm
    double hang_over_hip_m = 0.03;       ///< the wrist is not higher than this over the hip joint
    double velocity_smoothing_s = 0.15;  ///< time constant of that velocity, against the jitter of the hand
    double speed_smoothing_s = 0.3;      ///< time constant of its magnitude
    double palm_m = 0.09;                ///< middle of the palm, along the hand from the wrist
    double finger_m = 0.18;              ///< finger tips, along the hand from the wrist
  } gesture;

  struct Traces {
    double min_duration_s = 1.0;       ///< shorter gestures are rejected
    double min_extent_m = 0.25;        ///< two places of the right hand must be so far apart
    double dropout_s = 0.4;            ///< the gesture may be lost for so long without splitting the trace
    double gap_s = 1.0;                ///< without a frame for so long the trace ends
    double spacing_m = 0.01;           ///< a contact is kept when the wrist or the hand's point has moved so far
    double spacing_s = 0.1;            ///< … or after this time
    double hand_point_m = 0.15;        ///< the hand's point, along the hand from the wrist
    std::size_t max_contacts = 20000;  ///< bound of a trace; further contacts are counted, not kept
  } traces;

  /// The pivot gesture: the touching point held on one spot while the hand turns about it (a trace that draws nothing).
  struct Pivot {
    double min_duration_s = 3.0;   ///< on the spot; 0: no pivot gestures
    double reach_max_s = 2.5;      ///< way of the hand to the spot, and back
    double min_turn_rad = 0.6;     ///< largest turn of the hand
    double max_residual_m = 0.05;  ///< RMS distance of the touching point from the spot; more has drawn something
    double useful_m = 0.03;        ///< a gesture that leaves the distance from the wrist less certain says nothing
    double noise_m = 0.015;        ///< of one independent sample along each axis, at least: arm chain and jitter
    double independent_s = 1.5;    ///< samples within this time err together and count as one
    double systematic_m = 0.007;   ///< what the residuals cannot tell: the hand sensor's own misalignment
  } pivot;

  struct Sitting {
    double thigh_on = 0.40;      ///< (hip over knee) / thigh length, mean of both legs: 1 standing, 0 level thighs
    double thigh_low_on = 0.53;  ///< the same while the hips are below low_hips_m: short wearers on ordinary chairs
    double thigh_off = 0.65;
    double thigh_spread = 0.12;    ///< either thigh may exceed the limit of the mean by so much
    double low_hips_m = 0.65;      ///< hips over the floor below which steeper thighs are no perch
    double hips_min_share = 0.34;  ///< hips over the floor / leg length; lower is the floor, a deep squat or lying
    double hips_max_share = 0.88;
    double shank_min = 0.40;     ///< (knee over ankle) / shank length; less, with the ankle behind the knee, is a kneel
    double trunk_min = 0.35;     ///< upward part of the direction pelvis → neck; less is lying or a deep stoop
    double speed_on_mps = 0.12;  ///< the pelvis is still below this speed
    double speed_off_mps = 0.25;
    double smoothing_s = 0.25;   ///< time constant of that speed
    double outside_on_m = 0.05;  ///< centre of mass outside the foot polygon: something else carries the weight
    double outside_off_m = 0.03;
    double min_unsupported_share = 0.3;  ///< of the still time
    double min_unsupported_s = 1.0;
    double min_still_s = 1.5;      ///< shorter bouts are dropped
    double surely_still_s = 15.0;  ///< so long still is a seat, whatever carries the weight
    double dropout_s = 0.4;        ///< the posture may be lost for so long without ending the bout
    double gap_s = 2.0;            ///< without a frame for so long the bout ends
    double moved_m = 0.5;          ///< the pelvis rested so far from where the bout began: another place, another bout
    double hip_to_seat_m = 0.09;   ///< hip joints over the seat (hip joint to sitting bone)
    double seat_behind_hip_m = 0.07;  ///< seat centre behind the hip mid-point
    double sample_s = 0.1;            ///< spacing of the samples that are averaged
    std::size_t max_samples =
        600;  ///< bound of a bout; beyond it every second sample is dropped and the spacing doubled
  } sitting;
};

}  // namespace kinemap
