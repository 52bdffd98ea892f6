// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/graph/optimizer.hpp"
#include "core/mapper/associate.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// Decides what a new landmark is: one that is there already (a loop closure) or one of its own. Candidates come from
/// the relative marginal covariance; each plausible one is tried by optimising a copy of the map with the two made one,
/// and kept only if the optimum does not contradict it. Where two candidates explain it about equally well, it stays
/// separate until later evidence decides.
class LoopCloser {
 public:
  explicit LoopCloser(const MapperConfig& config) : config_(config) {}

  /// `newcomer` has just been added to `state`. True when a loop was closed; `state` is optimised then.
  bool resolve(MapState& state, std::size_t newcomer);

  /// Looks once more at all landmarks: with the drift corrected, two that were left separate may be one. True when some
  /// loop was closed.
  bool reconsider(MapState& state);

  /// Optimises with at most `iterations`. The right angles between walls are renewed first.
  bool optimise(MapState& state, int iterations) const;

 private:
  struct Trial {
    MapState state;
    double cost_increase = 0.0;
  };
  [[nodiscard]] Trial attempt(const MapState& state, std::size_t newcomer, const Candidate& candidate) const;

  /// Tries the newcomer's candidates, nearest first. True when one was accepted; `state` is optimised then.
  bool close(MapState& state, std::size_t newcomer, const std::vector<Candidate>& found);

  MapperConfig config_;
  std::vector<std::array<std::size_t, 2>>
      contradicted_;  ///< pairs that an optimum spoke against since the last closure
  std::uint32_t next_id_ = 1;
};

/// Soft priors that walls are parallel or at right angles, for all pairs that nearly are.
std::vector<graph::ParallelFactor> right_angles(const MapState& state, const MapperConfig::Walls& config);

}  // namespace kinemap
