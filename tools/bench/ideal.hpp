// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/wire/result.hpp"
#include "tools/sim/options.hpp"

namespace kinemap::bench {

/// How exactly the edges of one screen or table could be told.
struct IdealSize {
  std::uint32_t truth_id = 0;
  double suit_way_percent = 0.0;  ///< mean absolute percentage error of both edges, with the way as the suit has it
  double true_way_percent = 0.0;  ///< the same with the true pose of the pelvis at all times
};

/// What the best linear unbiased estimator makes of a simulated session: of each screen and table that was drawn all
/// round, the two edges from the hand as the suit reports it, its visits weighted by their information. It is given
/// what nobody else knows: the point that touches, when the hand touches and along which side, and the covariance of
/// the errors of this column (its odometry inside the gesture, metal, the arm's joints, the hand's unrest). An
/// estimator that has to find these out can hardly do better in one gesture; loops that close over other objects may
/// tell more of the way than the suit does, never more than the true one. Errors are those of the simulator's check().
Result<std::vector<IdealSize>> ideal_sizes(const sim::SimOptions& options);

}  // namespace kinemap::bench
