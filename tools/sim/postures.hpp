// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/score.hpp"
#include "tools/sim/wearer.hpp"

/// Where hands are held: each function gives a goal for one arm, scaled to the wearer.
namespace kinemap::sim::postures {

ArmGoal hanging(const Wearer& wearer, Side side);
/// Hand on its own hip.
ArmGoal on_hip(const Wearer& wearer, Side side, const HipStyle& style);
ArmGoal phone_at_ear(const Wearer& wearer, Side side);
ArmGoal crossed(const Wearer& wearer, Side side);
ArmGoal in_the_air(const Wearer& wearer, Side side);
ArmGoal scratching_head(const Wearer& wearer, Side side);
ArmGoal on_thigh(const Wearer& wearer, Side side);
ArmGoal touching(std::size_t touch);
/// Palm flat against a vertical surface at `p` whose normal is `n`.
ArmGoal against(const Wearer& wearer, const Vec3& p, const Vec3& n);
/// Finger tips at `p`, reaching down.
ArmGoal reaching_down(const Wearer& wearer, const Vec3& p);

}  // namespace kinemap::sim::postures
