// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/accuracy.hpp"

#include <charconv>
#include <filesystem>
#include <sstream>

#include "tools/bench/temporary_directory.hpp"
#include "tools/kinemap/batch.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/text_table.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

/// All that a simulated session depends on, as a directory name.
std::string cache_key(const sim::SimOptions& sim) {
  std::string key =
      cli::format("seed%llu-%s-%g", static_cast<unsigned long long>(sim.seed), to_string(sim.drift), sim.rate_hz);
  if (sim.rooms) key += cli::format("-rooms%d", *sim.rooms);
  if (sim.rounds) key += cli::format("-rounds%d", *sim.rounds);
  if (sim.packet_loss) key += cli::format("-loss%g", *sim.packet_loss);
  if (sim.stature_m) key += cli::format("-stature%g", *sim.stature_m);
  if (sim.closure_spacing_m) key += cli::format("-spacing%g", *sim.closure_spacing_m);
  return key +
         cli::format("-shell%d-slop%g%s", static_cast<int>(sim.shell), sim.sloppiness, sim.distractors ? "" : "-plain");
}

/// Makes the session unless it is there. truth.json is written last: where it is, the session is whole.
std::optional<Error> simulate(sim::SimOptions sim, const std::string& directory) {
  if (fs::exists(fs::path(directory) / "truth.json")) return std::nullopt;
  sim.out_dir = directory;
  const auto report = sim::simulate_to_directory(sim);
  if (!report) return Error{report.error()};
  return std::nullopt;
}

Result<Session> run_session(const AccuracyOptions& options, std::uint64_t seed, const std::string& cache) {
  sim::SimOptions sim = options.sim;
  sim.seed = seed;
  const fs::path directory = fs::path(cache) / cache_key(sim);
  if (auto error = simulate(sim, directory.string())) return *error;
  const auto built = cli::build_map((directory / "session.pcap").string(), options.config);
  if (!built) return Error{built.error()};
  const auto text = cli::read_file((directory / "truth.json").string());
  if (!text) return Error{text.error()};
  const auto truth = eval::truth_from_text(*text);
  if (!truth) return Error{(directory / "truth.json").string() + ": " + truth.error()};
  const auto evaluation = eval::evaluate(*built->map, *truth);
  if (!evaluation) return Error{directory.string() + ": " + evaluation.error()};
  if (options.keep) {
    const std::string out = (fs::path(*options.keep) / ("seed" + std::to_string(seed))).string();
    if (auto error = cli::make_output_directory(out)) return *error;
    if (auto error = cli::write_map_files(out, *built->map, built->graph)) return *error;
  }
  return Session{seed,
                 *evaluation,
                 built->recording.duration_s,
                 built->times.total_s(),
                 built->map->graph,
                 built->map->unresolved.size()};
}

}  // namespace

Result<std::vector<Session>> run_accuracy(const AccuracyOptions& options) {
  std::optional<TemporaryDirectory> temporary;
  if (options.cache.empty()) temporary.emplace();
  const std::string cache = temporary ? temporary->path() : options.cache;
  if (auto error = cli::make_output_directory(cache)) return *error;
  std::vector<Session> sessions;
  cli::ProgressBar bar("accuracy");
  for (const std::uint64_t seed : options.seeds) {
    bar.update(static_cast<double>(sessions.size()) / static_cast<double>(options.seeds.size()),
               "seed " + std::to_string(seed));
    auto session = run_session(options, seed, cache);
    if (!session) return Error{"seed " + std::to_string(seed) + ": " + session.error()};
    sessions.push_back(std::move(*session));
  }
  return sessions;
}

std::optional<std::vector<std::uint64_t>> parse_seeds(const std::string& text) {
  constexpr std::uint64_t kMost = 100000;
  std::vector<std::uint64_t> seeds;
  std::istringstream parts(text);
  std::string part;
  while (std::getline(parts, part, ',')) {
    std::uint64_t first = 0, last = 0;
    const char* const end = part.data() + part.size();
    auto [at, error] = std::from_chars(part.data(), end, first);
    if (error != std::errc{}) return std::nullopt;
    last = first;
    if (at != end) {
      if (*at != '-') return std::nullopt;
      const auto [stop, wrong] = std::from_chars(at + 1, end, last);
      if (wrong != std::errc{} || stop != end || last < first) return std::nullopt;
    }
    if (last - first >= kMost) return std::nullopt;
    for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
  }
  if (seeds.empty()) return std::nullopt;
  return seeds;
}

}  // namespace kinemap::bench
