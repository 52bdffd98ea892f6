// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/feet.hpp"
#include "core/tracker/smoothed_velocity.hpp"

namespace kinemap {

/// Finds the foot that carries the weight: at rest, flat, and not above the other one.
class StanceFold {
 public:
  explicit StanceFold(const TrackerConfig::Stance& config)
      : config_(config), velocity_{SmoothedVelocity(config.smoothing_s), SmoothedVelocity(config.smoothing_s)} {}

  /// Point on the sole under the ankle of the stance foot, in the pelvis frame (m); absent when no foot is at rest.
  std::optional<Eigen::Vector3d> step(const SuitFrame& frame, const std::array<Sole, 2>& soles);
  void reset();

 private:
  TrackerConfig::Stance config_;
  std::array<SmoothedVelocity, 2> velocity_;
  std::size_t held_ =
      0;  ///< the foot of the last stance: wins when both are as good, so that the answer does not flicker
};

}  // namespace kinemap
