// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/accuracy.hpp"

#include <charconv>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "tools/bench/parallel.hpp"
#include "tools/kinemap/batch.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/text_table.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

/// Makes the session unless it is there. truth.json is written last: where it is, the session is whole.
std::optional<Error> simulate(sim::SimOptions sim, const std::string& directory) {
  if (fs::exists(fs::path(directory) / "truth.json")) return std::nullopt;
  sim.out_dir = directory;
  const auto report = sim::simulate_to_directory(sim);
  if (!report) return Error{report.error()};
  return std::nullopt;
}

Result<std::shared_ptr<const eval::Truth>> read_truth(const std::string& path) {
  const auto text = cli::read_file(path);
  if (!text) return Error{text.error()};
  const auto truth = eval::truth_from_text(*text);
  if (!truth) return Error{path + ": " + truth.error()};
  return std::make_shared<const eval::Truth>(*truth);
}

std::optional<Error> keep_map(const std::string& directory, const cli::BatchResult& built) {
  if (auto error = cli::make_output_directory(directory)) return error;
  return cli::write_map_files(directory, *built.map);
}

/// One session with each configuration.
Result<std::vector<Session>> run_session(const sim::SimOptions& sim, const std::vector<Config>& configs,
                                         const fs::path& cache, const std::string& keep) {
  const std::string name = session_name(sim);
  const fs::path directory = cache / name;
  if (auto error = simulate(sim, directory.string())) return *error;
  const auto truth = read_truth((directory / "truth.json").string());
  if (!truth) return Error{truth.error()};
  std::vector<Session> sessions;
  for (const Config& config : configs) {
    const auto built = cli::build_map((directory / "session.pcap").string(), config);
    if (!built) return Error{built.error()};
    const auto evaluation = eval::evaluate(*built->map, **truth);
    if (!evaluation) return Error{directory.string() + ": " + evaluation.error()};
    if (!keep.empty())
      if (auto error = keep_map((fs::path(keep) / name).string(), *built)) return *error;
    sessions.push_back({sim, *evaluation, built->recording.duration_s, *truth, built->map});
  }
  return sessions;
}

}  // namespace

std::string session_name(const sim::SimOptions& sim) {
  std::string key = format("seed%llu-%s-%g-speed%g", static_cast<unsigned long long>(sim.seed), to_string(sim.drift),
                           sim.rate_hz, sim.speed);
  if (sim.rooms) key += format("-rooms%d", *sim.rooms);
  if (sim.rounds) key += format("-rounds%d", *sim.rounds);
  if (sim.packet_loss) key += format("-loss%g", *sim.packet_loss);
  if (sim.stature_m) key += format("-stature%g", *sim.stature_m);
  if (!sim.hold_feet) key += "-slipping";
  if (sim.closure_spacing_m) key += format("-spacing%g", *sim.closure_spacing_m);
  return key +
         format("-shell%d-slop%g%s", static_cast<int>(sim.shell), sim.sloppiness, sim.distractors ? "" : "-plain");
}

std::vector<sim::SimOptions> sessions_of(const std::vector<std::uint64_t>& seeds, const sim::SimOptions& base) {
  constexpr double kSloppiness[] = {0.2, 0.35, 0.5, 0.65, 0.8};
  std::vector<sim::SimOptions> sessions;
  for (const std::uint64_t seed : seeds) {
    sessions.push_back(base);
    sessions.back().seed = seed;
    sessions.back().sloppiness = kSloppiness[seed % std::size(kSloppiness)];
  }
  return sessions;
}

Result<std::vector<std::vector<Session>>> run_sessions(const std::vector<sim::SimOptions>& sessions,
                                                       const std::vector<Config>& configs, const RunOptions& options) {
  const fs::path cache = options.cache;
  if (auto error = cli::make_output_directory(cache.string())) return *error;

  std::vector<std::optional<Result<std::vector<Session>>>> done(sessions.size());
  cli::ProgressBar bar(options.label);
  std::mutex bar_mutex;
  std::size_t finished = 0;
  parallel_for(sessions.size(), options.jobs, [&](std::size_t i) {
    done[i] = run_session(sessions[i], configs, cache, options.keep);
    const std::scoped_lock lock(bar_mutex);
    ++finished;
    bar.update(static_cast<double>(finished) / static_cast<double>(sessions.size()),
               format("%zu of %zu sessions", finished, sessions.size()));
  });

  std::vector<std::vector<Session>> result(configs.size());
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    if (!*done[i]) return Error{"seed " + std::to_string(sessions[i].seed) + ": " + done[i]->error()};
    for (std::size_t c = 0; c < configs.size(); ++c) result[c].push_back(std::move((**done[i])[c]));
  }
  return result;
}

eval::Report report_of(const std::vector<Session>& sessions) {
  std::vector<eval::Evaluation> evaluations;
  for (const Session& session : sessions) evaluations.push_back(session.evaluation);
  return eval::summarise(evaluations);
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
