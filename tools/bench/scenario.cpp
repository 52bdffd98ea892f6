// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/kinemap/text_table.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kSixMinutes = 360.0;
constexpr std::uint64_t kSeedsTried = 12;

/// The seed whose session lasts nearest to six minutes; sessions are planned for this, not carried out.
Result<sim::SimOptions> pick_options() {
  sim::SimOptions best;
  double best_off = INFINITY;
  for (std::uint64_t seed = 1; seed <= kSeedsTried; ++seed) {
    sim::SimOptions options;
    options.seed = seed;
    options.rounds = 3;
    const auto source = sim::LiveSource::create(options);
    if (!source) return Error{source.error()};
    const double off = std::abs(source->report().duration_s - kSixMinutes);
    if (off >= best_off) continue;
    best_off = off;
    best = options;
  }
  return best;
}

}  // namespace

Result<Scenario> make_scenario(const std::string& directory, const std::string& recording) {
  if (!recording.empty()) return Scenario{recording, 0.0, recording};
  auto options = pick_options();
  if (!options) return Error{options.error()};
  options->out_dir = (fs::path(directory) / ("speed-seed" + std::to_string(options->seed))).string();
  const auto report = sim::simulate_to_directory(*options);
  if (!report) return Error{report.error()};
  return Scenario{report->session_path, report->duration_s,
                  format("simulated session, seed %llu, %d rooms, %.0f s",
                         static_cast<unsigned long long>(options->seed), report->rooms, report->duration_s)};
}

double percentile(std::vector<double>& values, double part) {
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(part * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::clamp(rank, 1.0, static_cast<double>(values.size()))) - 1];
}

}  // namespace kinemap::bench
