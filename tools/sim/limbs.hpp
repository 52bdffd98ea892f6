// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/body.hpp"

namespace kinemap::sim {

/// Bends the leg so that the ankle is at `ankle`, the knee towards `knee_towards`. The hip's parent (pelvis) is already
/// placed. Fills thigh and shank; the foot's position follows. False when the leg is too short: then it points there,
/// stretched.
bool solve_leg(const Body& body, Pose23& pose, Side side, const Vec3& ankle, const Vec3& knee_towards);

/// Bends the arm so that the wrist is at `wrist`, the elbow towards `elbow_towards` (a direction); the hand gets
/// `hand`. The shoulder's parent (T8) is already placed. False when out of reach: then the arm points there, nearly
/// stretched.
bool solve_arm(const Body& body, Pose23& pose, Side side, const Vec3& wrist, const Vec3& elbow_towards,
               const Quat& hand);

/// Orientation of a hand whose fingers point along `fingers` and whose palm faces `palm` (made perpendicular).
Quat hand_orientation(Side side, const Vec3& fingers, const Vec3& palm);

}  // namespace kinemap::sim
