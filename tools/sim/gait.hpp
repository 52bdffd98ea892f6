// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tools/sim/body.hpp"
#include "tools/sim/score.hpp"

namespace kinemap::sim {

/// A foot's stand on the floor: from `land` to `lift` (frames) its ball does not move.
struct Plant {
  std::size_t land = 0, lift = 0;
  Vec2 ankle;             ///< while the sole is flat
  double heading = 0.0;   ///< of the foot
  double roll_off = 0.0;  ///< heel rise when it lifts, rad
};

/// One foot at one frame.
struct FootState {
  Vec3 ball;  ///< m
  double heading = 0.0;
  double pitch = 0.0;  ///< heel up positive
  bool planted = true;
  std::size_t plant = 0;  ///< index of the plant; during a swing the one before
};

/// Steps that carry a body along a path which is known beforehand: the foot that is farthest from its place swings to
/// where it will be wanted, while the other stands.
struct Gait {
  std::array<std::vector<Plant>, 2> plants;    ///< [right, left]
  std::array<std::vector<FootState>, 2> feet;  ///< per frame
};

Gait make_gait(const Score& score, const Body& body);

}  // namespace kinemap::sim
