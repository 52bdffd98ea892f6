// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "tools/kinemap/evaluation.hpp"
#include "tools/sim/options.hpp"

namespace kinemap::bench {

/// One simulated session through sim → build → eval.
struct Session {
  sim::SimOptions sim;
  eval::Evaluation evaluation;
  double duration_s = 0.0;
  std::shared_ptr<const eval::Truth> truth;
  std::shared_ptr<const MapSnapshot> map;
};

struct RunOptions {
  std::string cache;  ///< simulated sessions are kept there and used again
  std::string keep;   ///< where each map goes, in a directory of the session's name; empty: nowhere
  int jobs = 0;       ///< sessions at the same time; 0: one for each core
  std::string label;  ///< of the progress bar
};

/// What the seeds do not draw by themselves: how carefully people touch, 0.2 to 0.8 in turn.
std::vector<sim::SimOptions> sessions_of(const std::vector<std::uint64_t>& seeds, const sim::SimOptions& base);

/// Simulates each session and builds it with each configuration: [configuration][session]. The result does not depend
/// on the number of jobs. The first Error, in the order of the sessions, is returned.
Result<std::vector<std::vector<Session>>> run_sessions(const std::vector<sim::SimOptions>& sessions,
                                                       const std::vector<Config>& configs, const RunOptions& options);

/// All that a simulated session depends on, as a name: "seed3-default-…".
std::string session_name(const sim::SimOptions& sim);

eval::Report report_of(const std::vector<Session>& sessions);

/// "1-9,12" → 1 … 9, 12. nullopt when it is no such list.
std::optional<std::vector<std::uint64_t>> parse_seeds(const std::string& text);

}  // namespace kinemap::bench
