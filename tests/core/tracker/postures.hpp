// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/core/tracker/puppet.hpp"

namespace kinemap::test {

// Whole-body postures. Lengths are for a stature of 1.75 m and scale with the puppet; seat heights do not.
Figure standing();
/// On a seat of that height, pelvis rolled back by 25°, which leaves 65° of hip flexion.
Figure sitting(const Puppet& puppet, double seat_m);
Figure sitting_leaning(const Puppet& puppet,
                       double seat_m);  ///< 45° forward with tucked feet: the mass is over the feet
Figure sitting_cross_legged(const Puppet& puppet, double seat_m);  ///< right ankle on the left knee
Figure sitting_twisted(const Puppet& puppet, double seat_m);       ///< chest 40° to the left
Figure lounging(const Puppet& puppet, double seat_m);              ///< reclined by 35°
Figure squatting(const Puppet& puppet, double hips_m);             ///< flat feet, balanced
Figure squatting_on_toes(const Puppet& puppet);
Figure kneeling_on_heels();
Figure kneeling_upright();
Figure kneeling_on_one_knee();
Figure stooping(const Puppet& puppet);
Figure perching(const Puppet& puppet, double thigh_rad);  ///< thighs so far below level, shanks a little forward
Figure lying(double surface_m);
Figure sitting_on_floor();
Figure leaning_on_wall();

/// Walks forward along its heading with planted feet; hips at distance speed·t from `from`.
Figure walking(double t, double speed_mps, const Eigen::Vector2d& from = {0, 0}, double heading = 0.0);
/// Crouches to thighs about level and springs up, once per second.
Figure jumping(const Puppet& puppet, double t);

/// How the left hand rests on the hip.
struct HipStyle {
  bool fist = false;               ///< the wrist, not the palm, at the crest
  bool thumb_forward = false;      ///< fingers to the back
  Eigen::Vector3d shift{0, 0, 0};  ///< of the hand: forward, outward, up
};
ArmSpec on_hip(const HipStyle& style = {});
ArmSpec hanging();
ArmSpec at_ear();
ArmSpec before_belly();  ///< one of two crossed arms
ArmSpec in_pocket();
ArmSpec in_lap();
ArmSpec scratching(double t);
ArmSpec waving(double t);
ArmSpec running_swing(double t);
ArmSpec typing(double t);
/// The right hand along the outline of an upright rectangle before the chest, one round in 8 s.
ArmSpec drawing(double t);

}  // namespace kinemap::test
