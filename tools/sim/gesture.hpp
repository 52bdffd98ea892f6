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

/// The motion along one object: hand samples and the body with them.
struct Stroke {
  int object = 0;
  std::vector<TouchPoint> touch;
  std::vector<bool> lifted;  ///< per sample: off the surface
  std::vector<Vec2> ground;
  std::vector<double> heading;
  int part = 1, parts = 1;  ///< of an object that is drawn in several gestures
};

/// The body's way along with the hand: on the outward side of what is touched, clear of everything. Touches are left to
/// the caller.
Stroke accompany(Composer& composer, int object, const std::vector<ContourSample>& samples, const Stance& stance);

/// Walks to the start, makes one gesture along all the strokes, and labels each. Objects that were drawn; none when one
/// cannot get there.
std::vector<int> perform(Composer& composer, const std::vector<Stroke>& strokes);

}  // namespace kinemap::sim
