// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/pose.hpp"

namespace kinemap {

/// Whether a person's pelvis can get from `a` to `b` in so many seconds (both in one world). Running, jumping from a
/// chair and turning on the heel are within reach, and so is what a suit corrects at a step; no body moves 0.2 m or
/// turns 20° between two frames.
bool within_reach(const Pose& a, const Pose& b, double seconds);

/// Where the pelvis is, in the world of `before`, when the body stayed and only the suit's world was moved: the place
/// and the heading of `before`, leaning as `after` says (gravity is the same in both worlds).
Pose stayed(const Pose& before, const Pose& after);

}  // namespace kinemap
