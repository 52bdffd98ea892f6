// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
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
  explicit LoopCloser(const MapperConfig& config) : config_(config), expected_doubt_(config.association.doubt) {}

  /// `newcomer` has just been added to `state`. True when a loop was closed. `state` is optimised.
  bool resolve(MapState& state, std::size_t newcomer);

  /// Looks once more at all landmarks: with the drift corrected, two that were left separate may be one. True when some
  /// loop was closed.
  bool reconsider(MapState& state);

  /// Takes back what the optimum contradicts by now: each visit that was merged into an object is given one of its own
  /// for a trial, and keeps it when the map then costs less by more than a closure may cost. What was taken back is
  /// free to find its place anew. Visits on the settled part of the way stay. True when something changed; `state` is
  /// optimised then.
  /// `enough` (none: never) ends it early.
  bool revise(MapState& state, const std::function<bool()>& enough = {});

  /// Optimises, then chooses the sides of rectangles anew for the contacts and optimises again while that changes any.
  bool settle(MapState& state, int iterations) const;

  /// Optimises with at most `iterations`.
  bool optimise(MapState& state, int iterations) const;

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(contradicted_, next_id_);
  }

 private:
  struct Trial {
    MapState state;
    double cost_increase = 0.0;
  };
  [[nodiscard]] Trial attempt(const MapState& state, std::size_t newcomer, const Candidate& candidate) const;

  /// Decides anew which walls keep to the building's direction; optimises when that changed.
  bool align(MapState& state) const;

  /// Whether the first candidate has so much more evidence than any other that is certainly another object.
  [[nodiscard]] bool is_clear(const MapState& state, const graph::Marginals& marginals,
                              const std::vector<Candidate>& found) const;

  /// Tries the newcomer's candidates; the best, by what free space says too, is taken unless another is about as good.
  /// True when it was accepted; `state` is optimised then.
  bool close(MapState& state, std::size_t newcomer, const graph::Marginals& marginals, std::vector<Candidate> found);

  /// After a long way what was seen before and after it can be too little evidence each, and certain together: where
  /// one closure makes others likely, it is taken. True when it was. `marginals`: of `state`.
  bool close_jointly(MapState& state, const graph::Marginals& marginals);

  [[nodiscard]] bool is_contradicted(std::size_t a, std::size_t b) const;

  /// The doubt about the graph's covariance falls as contacts and loops tell that this suit errs less than expected.
  void learn(const MapState& state);

  MapperConfig config_;  ///< association.doubt as learn() has it
  double expected_doubt_;
  std::vector<std::array<std::size_t, 2>>
      contradicted_;  ///< pairs that an optimum spoke against since the last closure
  std::uint32_t next_id_ = 1;
};

}  // namespace kinemap
