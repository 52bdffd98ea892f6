// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/sim/gait.hpp"
#include "tools/sim/limbs.hpp"
#include "tools/sim/score.hpp"
#include "tools/sim/wearer.hpp"

namespace kinemap::sim {

/// Turns the score into a body: trunk lean where the right hand must reach far, pelvis bob and sway from the steps, and
/// the joints of arms and legs by inverse kinematics. True poses, building's frame.
class Performer {
 public:
  Performer(const Score& score, const Gait& gait, const Wearer& wearer, Random& random);

  [[nodiscard]] Pose23 pose(std::size_t frame) const;
  /// Position of the pelvis alone.
  [[nodiscard]] Vec3 pelvis(std::size_t frame) const;
  [[nodiscard]] std::size_t frames() const { return trunk_.size(); }

 private:
  /// Pelvis and trunk at one frame.
  struct Trunk {
    Vec2 sway{0, 0};                           ///< of the pelvis, world axes, m
    double height = 0.0;                       ///< of the pelvis, m
    double lean = 0.0;                         ///< of the chest, rad
    double twist = 0.0;                        ///< of the chest, rad
    double swing_yaw = 0.0, swing_roll = 0.0;  ///< of the pelvis with the steps, rad
    double tempo = 0.0;                        ///< 0 standing … 1 walking
  };
  struct ArmAim {
    Vec3 wrist, elbow;
    Quat hand;
  };

  /// The touch's point at the frame; before it the first, after it the last one.
  [[nodiscard]] const TouchPoint& touch_at(const ArmGoal& goal, std::size_t frame) const;
  void place_trunk(Pose23& pose, std::size_t frame, double lean, double twist) const;
  [[nodiscard]] ArmAim aim_for_touch(const TouchPoint& touch, const Vec3& shoulder) const;
  [[nodiscard]] ArmAim aim(const Pose23& pose, Side side, const ArmGoal& goal, std::size_t frame) const;
  void place_arm(Pose23& pose, Side side, std::size_t frame) const;
  void place_leg(Pose23& pose, Side side, std::size_t frame) const;
  [[nodiscard]] Vec3 ankle(Side side, std::size_t frame) const;
  [[nodiscard]] double needed_lean(const TouchPoint& touch, std::size_t frame) const;
  void plan_sway(Random& random);
  void plan_reach();
  void plan_height();

  const Score& score_;
  const Gait& gait_;
  const Wearer& wearer_;
  std::vector<Trunk> trunk_;
};

}  // namespace kinemap::sim
