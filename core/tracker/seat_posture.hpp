// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/feet.hpp"

namespace kinemap {

/// The measures by which a seated body is told from others; all inside the body and against gravity, so free of drift.
struct SeatPosture {
  double thigh_mean = 1.0;  ///< (z_hip − z_knee) / thigh length, mean of both legs: 1 standing, 0 level thighs
  double thigh_max = 1.0;   ///< the steeper thigh
  double hips_m = 0.0;      ///< hip mid-point over the floor under the feet
  double hips_share = 1.0;  ///< the same as a share of the leg's length, sole included
  double trunk_up = 1.0;    ///< upward part of the unit vector pelvis → neck
  bool kneels = false;      ///< a level shank with the ankle behind the knee
};

SeatPosture seat_posture_of(const SuitFrame& frame, const std::array<Sole, 2>& soles, double shank_min);

/// Whether the legs sit; `active` is the answer for the frame before (hysteresis). Whether anything carries the weight
/// is another question: a squat passes here.
bool legs_sit(const SeatPosture& posture, bool active, const TrackerConfig::Sitting& config);

}  // namespace kinemap
