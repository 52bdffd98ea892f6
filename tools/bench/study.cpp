// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/study.hpp"

#include <algorithm>
#include <filesystem>

#include "tools/bench/parallel.hpp"
#include "tools/bench/temporary_directory.hpp"
#include "tools/kinemap/batch.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

std::vector<sim::SimOptions> sessions_of(const StudyOptions& options, const std::string& drift) {
  sim::SimOptions base = options.sim;
  base.drift = *sim::severity_from(drift);
  return bench::sessions_of(options.seeds, base);
}

Result<std::vector<Session>> run(const std::vector<sim::SimOptions>& sessions, const StudyOptions& options,
                                 const std::string& label) {
  RunOptions how = options.run;
  how.label = label;
  auto runs = run_sessions(sessions, {options.config}, how);
  if (!runs) return Error{runs.error()};
  return std::move(runs->front());
}

Result<std::vector<std::vector<IdealSize>>> run_ideal(const std::vector<sim::SimOptions>& sessions, int jobs) {
  std::vector<std::optional<Result<std::vector<IdealSize>>>> done(sessions.size());
  parallel_for(sessions.size(), jobs, [&](std::size_t i) { done[i] = ideal_sizes(sessions[i]); });
  std::vector<std::vector<IdealSize>> out;
  for (auto& sizes : done) {
    if (!*sizes) return Error{sizes->error()};
    out.push_back(std::move(**sizes));
  }
  return out;
}

std::optional<Error> run_columns(const StudyOptions& options, Study& study) {
  for (const std::string& drift : options.drifts) {
    auto sessions = run(sessions_of(options, drift), options, drift + " drift");
    if (!sessions) return Error{drift + " drift, " + sessions.error()};
    auto ideal = run_ideal(sessions_of(options, drift), options.run.jobs);
    if (!ideal) return Error{drift + " drift, " + ideal.error()};
    study.columns.push_back({drift, std::move(*sessions), std::move(*ideal)});
  }
  return std::nullopt;
}

std::optional<Error> run_ablation(const StudyOptions& options, Study& study) {
  const auto usual = std::find(options.drifts.begin(), options.drifts.end(), "default");
  study.ablated = usual == options.drifts.end() ? 0 : static_cast<std::size_t>(usual - options.drifts.begin());
  std::vector<Config> configs;
  for (const Lever& lever : levers()) {
    auto config = without(options.config, lever);
    if (!config) return Error{config.error()};
    configs.push_back(std::move(*config));
  }
  RunOptions how = options.run;
  how.label = "levers";
  how.keep.clear();
  auto runs = run_sessions(sessions_of(options, options.drifts[study.ablated]), configs, how);
  if (!runs) return Error{"levers, " + runs.error()};
  for (std::size_t k = 0; k < configs.size(); ++k) study.ablation.push_back({levers()[k], std::move((*runs)[k])});
  return std::nullopt;
}

std::optional<Error> run_slipping(const StudyOptions& options, Study& study) {
  const auto deaf = without(options.config, feet_not_heard());
  if (!deaf) return Error{deaf.error()};
  StudyOptions slipping = options;
  slipping.sim.hold_feet = false;
  slipping.run.keep.clear();
  for (const std::string& drift : options.drifts) {
    slipping.run.label = "slipping feet, " + drift + " drift";
    auto runs = run_sessions(sessions_of(slipping, drift), {options.config, *deaf}, slipping.run);
    if (!runs) return Error{slipping.run.label + ", " + runs.error()};
    study.slipping.push_back({drift, std::move((*runs)[0]), std::move((*runs)[1])});
  }
  return std::nullopt;
}

std::optional<Error> run_sparse(const StudyOptions& options, Study& study) {
  StudyOptions sparse = options;
  study.sparse_spacing_m = options.sparse_spacing_m;
  sparse.sim.closure_spacing_m = options.sparse_spacing_m;
  auto sessions = run(sessions_of(sparse, "default"), sparse, "few closures");
  if (!sessions) return Error{"few closures, " + sessions.error()};
  study.sparse = std::move(*sessions);
  return std::nullopt;
}

std::optional<Error> run_quiet(const StudyOptions& options, Study& study) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(options.recordings, code))
    if (entry.path().extension() == ".pcap" || entry.path().extension() == ".mvnx") files.push_back(entry.path());
  if (files.empty()) return Error{options.recordings + ": no .pcap and no .mvnx in it"};
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const auto built = cli::build_map(file.string(), options.config);
    if (!built) return Error{built.error()};
    study.quiet.push_back({file.stem().string(), built->recording.duration_s, built->map->objects.size()});
  }
  return std::nullopt;
}

}  // namespace

Result<Study> run_study(const StudyOptions& options) {
  StudyOptions all = options;
  std::optional<TemporaryDirectory> temporary;
  if (all.run.cache.empty()) all.run.cache = temporary.emplace().path();
  Study study;
  if (auto error = run_columns(all, study)) return *error;
  if (all.ablation)
    if (auto error = run_ablation(all, study)) return *error;
  if (all.slipping_feet)
    if (auto error = run_slipping(all, study)) return *error;
  if (all.sparse_spacing_m > 0.0)
    if (auto error = run_sparse(all, study)) return *error;
  if (!all.recordings.empty())
    if (auto error = run_quiet(all, study)) return *error;
  return study;
}

}  // namespace kinemap::bench
