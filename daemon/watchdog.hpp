// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

namespace kinemap {

/// How far the solver thread is.
struct SolverProgress {
  std::uint64_t steps = 0;   ///< grows with each entry that it has mapped, restored ones too
  std::uint64_t cpu_ns = 0;  ///< processor time that it has had
  bool has_work = false;     ///< it is at an entry, or one waits for it
};

/// Decides whether systemd is told that the daemon lives. The detection loop must have come round since the last look.
/// A solver that computes is left alone, however long it is at one entry: what it computes follows from the journal, so
/// another one would have to do the same again, and until then less of the map would be there (status, metrics and log
/// say how long it has been). One that has work and has not moved at all for `patience` looks, as when it waits for
/// something that never comes, is past help: only a restart brings the map back.
class Watchdog {
 public:
  /// `pulse`, `solver`: as they are at the start. `patience`: in looks.
  Watchdog(std::uint64_t pulse, const SolverProgress& solver, int patience)
      : pulse_(pulse), solver_(solver), patience_(patience) {}

  /// To be called at even intervals; true: all that should has moved since.
  bool look(std::uint64_t pulse, const SolverProgress& solver) {
    const bool came_round = std::exchange(pulse_, pulse) != pulse;
    const bool moved = solver.steps != solver_.steps || solver.cpu_ns != solver_.cpu_ns;
    solver_ = solver;
    idle_looks_ = moved || !solver.has_work ? 0 : idle_looks_ + 1;
    return came_round && !solver_is_stuck();
  }
  [[nodiscard]] bool solver_is_stuck() const { return idle_looks_ >= patience_; }

 private:
  std::uint64_t pulse_;
  SolverProgress solver_;
  int patience_;
  int idle_looks_ = 0;  // on which the solver had work and had not moved
};

}  // namespace kinemap
