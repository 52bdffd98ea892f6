// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/body.hpp"
#include "tools/sim/habits.hpp"

namespace kinemap::sim {

/// Who wears the suit, and what is particular to them.
struct Wearer {
  Body body;
  bool palm = false;           ///< touches with the flat palm instead of the finger tips
  Vec3 p_hand_touch{0, 0, 0};  ///< the touching point in the right hand's segment frame, m
  double walk_speed = 1.0;     ///< m/s
  double trace_speed = 0.28;   ///< m/s, on tables and screens
  double sloppiness = 0.5;     ///< 0–1
  Habits habits;
};

}  // namespace kinemap::sim
