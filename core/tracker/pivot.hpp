// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "core/events.hpp"
#include "core/tracker/config.hpp"

namespace kinemap {

/// The right hand at one instant of a gesture.
struct HandSample {
  double time_s = 0.0;
  Pose T_odom_hand;
};

/// Whether the touching point was held on one fixed spot c while the hand turned about it, and if so, where in the hand
/// that point p is: T_odom_hand,i · p = c for all i, least squares in closed form, robustly, so that the way to the
/// spot and back does not matter. Turning about one axis alone leaves p undetermined along that axis: the covariance
/// says so.
///
/// Noise of the arm is correlated over seconds (joint angles, jitter), so the covariance counts one independent sample
/// in `independent_s`, not one a frame, is scaled by the residuals, and is never better than `systematic_m`.
///
/// nullopt when the hand drew something (no fixed point of the hand's own explains it), hardly turned, or too short.
std::optional<Pivot> find_pivot(std::span<const HandSample> samples, const TrackerConfig::Pivot& config);

}  // namespace kinemap
