// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/bench/commands.hpp"
#include "tools/bench/scenario.hpp"
#include "tools/bench/temporary_directory.hpp"
#include "tools/kinemap/batch.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

struct Options {
  std::string recording;
  int runs = 9;
  bool json = false;
};

/// Median and minimum of one stage over the runs, s.
struct Stage {
  const char* name;
  double median_s, fastest_s;
};

Stage stage_of(const char* name, const std::vector<cli::StageTimes>& runs, double (*seconds)(const cli::StageTimes&)) {
  std::vector<double> values;
  for (const cli::StageTimes& run : runs) values.push_back(seconds(run));
  return {name, percentile(values, 0.5), values.front()};
}

double peak_megabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

int pipeline(const Options& options) {
  const TemporaryDirectory directory;
  const auto scenario = make_scenario(directory.path(), options.recording);
  if (!scenario) return cli::fail("pipeline", scenario.error());
  std::vector<cli::StageTimes> runs;
  double duration_s = 0.0;
  {
    cli::ProgressBar bar("pipeline");
    for (int i = 0; i < options.runs; ++i) {
      bar.update(static_cast<double>(i) / options.runs);
      const auto result = cli::build_map(scenario->recording, Config{});
      if (!result) return cli::fail("pipeline", result.error());
      runs.push_back(result->times);
      duration_s = result->recording.duration_s;
    }
  }
  const Stage stages[] = {
      stage_of("read (pcap, MXTP, assembler)", runs, [](const cli::StageTimes& t) { return t.read_s; }),
      stage_of("tracker", runs, [](const cli::StageTimes& t) { return t.track_s; }),
      stage_of("mapper (landmarks, association, optimiser)", runs, [](const cli::StageTimes& t) { return t.map_s; }),
      stage_of("all", runs, [](const cli::StageTimes& t) { return t.total_s(); })};
  if (options.json) {
    nlohmann::ordered_json json = {{"scenario", scenario->name},
                                   {"duration_s", duration_s},
                                   {"runs", options.runs},
                                   {"peak_mb", peak_megabytes()}};
    for (const Stage& stage : stages)
      json["stages"][stage.name] = {{"median_s", stage.median_s},
                                    {"fastest_s", stage.fastest_s},
                                    {"times_real_time", duration_s / stage.median_s}};
    return cli::print("pipeline", pretty_text(json));
  }
  std::string text =
      format("%s, %d runs in one thread\n\n| stage | median s | fastest s | × real time |\n|---|---|---|---|\n",
             scenario->name.c_str(), options.runs);
  for (const Stage& stage : stages)
    text += format("| %s | %.3f | %.3f | %.0f |\n", stage.name, stage.median_s, stage.fastest_s,
                   duration_s / stage.median_s);
  return cli::print("pipeline", text + format("\npeak memory of the process: %.0f MB\n", peak_megabytes()));
}

}  // namespace

void add_pipeline(CLI::App& app, cli::Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      cli::add_command(app, run, "pipeline", "How fast a recording becomes a map, stage by stage",
                       "  bench pipeline\n  bench pipeline --recording session.pcap --runs 3\n", options, pipeline);
  command->add_option("--recording", options->recording, "Default: a simulated session of about six minutes")
      ->type_name("FILE");
  command->add_option("--runs", options->runs, "How often")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_flag("--json", options->json, "Print the figures as JSON");
}

}  // namespace kinemap::bench
