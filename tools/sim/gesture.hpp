// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/composer.hpp"
#include "tools/sim/contour.hpp"

namespace kinemap::sim {

/// How the body goes along with the hand.
struct Stance {
  double standoff = 0.3;   ///< pelvis from the touched line, m
  double face_turn = 0.0;  ///< heading minus the direction to the surface, rad
  double lag = 0.0;        ///< pelvis behind a hand that goes to the left along the surface, m
  double to_left = 0.15;   ///< pelvis to its own left of the hand, m: the right hand is the pen
  double follow_s = 0.5;   ///< smoothing of the body's way
};

/// The motion of one gesture: hand samples and the body with them.
struct Gesture {
  std::vector<TouchPoint> touch;
  std::vector<Vec2> ground;
  std::vector<double> heading;
};

/// The body's way along with the hand: on the outward side of what is touched, clear of everything. Touches are left to
/// the caller.
Gesture accompany(Composer& composer, const std::vector<ContourSample>& samples, const Stance& stance);

/// Walks to the start, makes the gesture, and labels it. False when one cannot get there.
bool perform(Composer& composer, const Gesture& gesture, int object);

}  // namespace kinemap::sim
