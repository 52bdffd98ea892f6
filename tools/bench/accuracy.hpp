// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "tools/kinemap/evaluation.hpp"
#include "tools/sim/options.hpp"

namespace kinemap::bench {

struct AccuracyOptions {
  std::vector<std::uint64_t> seeds;
  sim::SimOptions sim;              ///< seed and out_dir are filled in
  std::string cache;                ///< simulated sessions, kept for the next run; empty: a temporary directory
  std::optional<std::string> keep;  ///< where each seed's map goes
  Config config;
};

/// One seed through sim → build → eval.
struct Session {
  std::uint64_t seed = 0;
  eval::Evaluation evaluation;
  double duration_s = 0.0;
  double build_s = 0.0;
  GraphSummary graph;
  std::size_t unresolved = 0;
};

/// Runs all seeds, each in this process and thread, in order. The first Error ends it.
Result<std::vector<Session>> run_accuracy(const AccuracyOptions& options);

/// "1-9,12" → 1 … 9, 12. nullopt when it is no such list.
std::optional<std::vector<std::uint64_t>> parse_seeds(const std::string& text);

}  // namespace kinemap::bench
