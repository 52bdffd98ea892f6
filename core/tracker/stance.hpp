// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/feet.hpp"
#include "core/tracker/smoothed_velocity.hpp"

namespace kinemap {

/// Finds the foot that carries the weight: at rest for a moment, flat, and not above another such foot.
class StanceFold {
 public:
  explicit StanceFold(const TrackerConfig::Stance& config)
      : config_(config), velocity_{SmoothedVelocity(config.smoothing_s), SmoothedVelocity(config.smoothing_s)} {
    reset();
  }

  /// Point on the sole under the ankle of the stance foot, in the pelvis frame (m); absent when no foot is at rest.
  std::optional<Eigen::Vector3d> step(const SuitFrame& frame, const std::array<Sole, 2>& soles);
  void reset();

 private:
  TrackerConfig::Stance config_;
  std::array<SmoothedVelocity, 2> velocity_;
  std::array<double, 2> moved_s_{};  ///< when each foot last moved
  std::size_t held_ = 0;             ///< the foot of the last stance; keeps the answer from flickering between equals
};

}  // namespace kinemap
