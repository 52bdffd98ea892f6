// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

namespace kinemap {

/// How far the solver thread is.
struct SolverProgress {
  std::uint64_t steps = 0;  ///< grows with each entry that it has mapped, restored ones too
  bool has_work = false;    ///< it is at an entry, or one waits for it
};

/// Decides whether systemd is told that the daemon lives. The detection loop must have come round since the last look.
/// The solver may be long at one entry, as in optimising a long day; but when it has been at the same one for
/// `patience` looks, nothing comes of it any more, and only a restart brings the map back. A solver that is merely
/// behind, be its ring full, goes on from entry to entry and is no reason.
class Watchdog {
 public:
  /// `pulse`, `solver`: as they are at the start. `patience`: in looks.
  Watchdog(std::uint64_t pulse, const SolverProgress& solver, int patience)
      : pulse_(pulse), steps_(solver.steps), patience_(patience) {}

  /// To be called at even intervals; true: all that should has moved since.
  bool look(std::uint64_t pulse, const SolverProgress& solver) {
    const bool came_round = std::exchange(pulse_, pulse) != pulse;
    const bool went_on = std::exchange(steps_, solver.steps) != solver.steps;
    idle_looks_ = went_on || !solver.has_work ? 0 : idle_looks_ + 1;
    return came_round && !solver_is_stuck();
  }
  [[nodiscard]] bool solver_is_stuck() const { return idle_looks_ >= patience_; }

 private:
  std::uint64_t pulse_, steps_;
  int patience_;
  int idle_looks_ = 0;  // on which the solver was at the same entry as before
};

}  // namespace kinemap
