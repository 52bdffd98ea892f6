// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/geometry.hpp"
#include "tools/sim/random.hpp"

namespace kinemap::sim {

/// How a hand rests on its own hip. Directions are given for the left side: forward, outward, up.
struct HipStyle {
  double elbow_angle = 1.4;  ///< inside the elbow, rad: the wider, the lower the hand
  Vec2 offset{0, 0};         ///< from the usual place on the hip: forward and outward, m
  Vec3 elbow{-0.45, 1.0, -0.1}, fingers{0.75, -0.55, -0.35}, palm{0.1, -0.7, -0.7};
};

/// What is particular to somebody's tracing. Chances are drawn anew at each corner, edge or gesture.
struct Habits {
  double corner_round_m = 0.02;                      ///< corners are cut by up to this
  double overshoot_chance = 0.0, overshoot_m = 0.0;  ///< the hand goes past a corner, and comes back
  double dwell_chance = 0.5, dwell_s = 0.5;          ///< rests at corners and ends
  double pause_per_m = 0.0, pause_s = 0.0;           ///< rests on the way along an edge
  double lift_per_s = 0.0, lift_m = 0.03;            ///< leaves the surface for 0.3–1 s and comes back farther on
  double graze_per_s = 0.08;                         ///< lifts by a centimetre or two
  double unrest = 1.0;                               ///< factor on the hand's trembling
  double pace_spread = 0.15;                         ///< part by which the speed varies along the way
  double end_miss_m = 0.02;      ///< an open contour begins or ends so far from the corner, a closed one gapes so
  double end_past_m = 0.08;      ///< a closed contour goes on so far past its beginning
  double mid_edge_chance = 0.5;  ///< a contour begins in the middle of an edge
  double whole_chance = 0.6;     ///< a table is gone round where that is possible; else …
  double three_chance = 0.25;    ///< … three sides are drawn, else two
  double split_chance = 0.0;     ///< an object is drawn in two gestures
  double chain_chance = 0.0;     ///< two objects are drawn in one gesture
  double lead_s = 0.0;           ///< the left hand is on the hip up to so long before one has arrived
  double trail_s = 0.8;          ///< the left hand stays on the hip up to so long after the right one has left
  double walk_off_chance = 0.0;  ///< walks on before the left hand has come down
  double odd_hip_chance = 0.0;   ///< the left hand is held in another way than usual
  double hip_scatter_m = 0.008;  ///< where on the hip it comes to lie, from gesture to gesture
  HipStyle hip;
};

/// Draws somebody's habits: 0 careful … 1 careless. At 0.5 most gestures are clean and each habit occurs.
Habits draw_habits(double sloppiness, Random& random);
/// Fist, fingers forward or thumb forward; higher or lower, farther in front or behind.
HipStyle draw_hip_style(double sloppiness, Random& random);
/// The style of one gesture.
HipStyle hip_of_gesture(const Habits& habits, double sloppiness, Random& random);

}  // namespace kinemap::sim
