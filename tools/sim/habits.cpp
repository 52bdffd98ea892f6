// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/habits.hpp"

namespace kinemap::sim {

HipStyle draw_hip_style(double sloppiness, Random& random) {
  HipStyle style;
  style.elbow_angle = radians(random.uniform(60.0, 100.0 + 12.0 * sloppiness));
  style.offset = Vec2(random.uniform(-0.05 - 0.03 * sloppiness, 0.05), random.uniform(-0.01, 0.04));
  switch (random.integer(0, 2)) {
    case 0:  // fingers forward, thumb behind: as initialised
      break;
    case 1:  // thumb forward, fingers on the small of the back
      style.elbow = {0.15, 1.0, -0.1};
      style.fingers = {-0.55, -0.6, -0.45};
      style.palm = {0.45, -0.75, -0.3};
      style.offset.x() -= 0.02;
      break;
    default:  // fist: knuckles in the side, the wrist farther out
      style.elbow = {-0.2, 1.0, -0.1};
      style.fingers = {0.2, -0.9, -0.35};
      style.palm = {-0.3, -0.4, -0.85};
      style.offset.y() += 0.02;
      break;
  }
  return style;
}

Habits draw_habits(double sloppiness, Random& random) {
  Habits h;
  const double s = sloppiness;
  // People differ: one rounds every corner and never lifts the hand, another one does the opposite.
  const auto trait = [&] { return s * random.uniform(0.0, 2.0); };
  h.corner_round_m = 0.012 + 0.03 * trait();
  h.overshoot_chance = 0.2 * trait();
  h.overshoot_m = 0.015 + 0.02 * trait();
  h.dwell_chance = random.uniform(0.2, 0.8);
  h.dwell_s = 0.4 + 0.7 * trait();
  h.pause_per_m = 0.12 * trait();
  h.pause_s = 0.5 + 0.8 * trait();
  h.lift_per_s = 0.035 * trait();
  h.lift_m = 0.03 + 0.03 * trait();
  h.graze_per_s = 0.16 * s;
  h.unrest = 0.5 + s;
  h.pace_spread = 0.08 + 0.2 * trait();
  h.end_miss_m = 0.01 + 0.02 * trait();
  h.end_past_m = 0.05 + 0.10 * trait();
  h.mid_edge_chance = random.uniform(0.1, 0.8);
  h.whole_chance = random.uniform(0.25, 0.85);
  h.three_chance = random.uniform(0.1, 0.4);
  h.split_chance = 0.2 * trait();
  h.chain_chance = 0.3 * trait();
  h.lead_s = 0.35 + 1.0 * trait();
  h.trail_s = 0.6 + 0.6 * trait();
  h.walk_off_chance = 0.4 * trait();
  h.odd_hip_chance = 0.2 * trait();
  h.hip_scatter_m = 0.006 + 0.008 * trait();
  h.hip = draw_hip_style(s, random);
  return h;
}

HipStyle hip_of_gesture(const Habits& habits, double sloppiness, Random& random) {
  HipStyle style = random.chance(habits.odd_hip_chance) ? draw_hip_style(sloppiness, random) : habits.hip;
  style.offset += Vec2(random.normal(habits.hip_scatter_m), random.normal(0.7 * habits.hip_scatter_m));
  style.elbow_angle += random.normal(0.04);
  return style;
}

}  // namespace kinemap::sim
