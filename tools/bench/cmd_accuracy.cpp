// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/bench/commands.hpp"
#include "tools/bench/document.hpp"
#include "tools/bench/tables.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

using cli::fail;
using cli::print;
using Json = nlohmann::ordered_json;

struct Options {
  std::string seeds = "1-9";
  std::vector<std::string> drifts = {"default"};
  std::string cache, keep, markdown, config, recordings;
  double closure_spacing_m = 0.0;
  int rooms = 0, jobs = 0;
  bool ablation = false, slipping_feet = false, json = false;
};

/// The command that gives the same document; where things are kept does not matter.
std::string command_of(const Options& options) {
  std::string drifts;
  for (const std::string& drift : options.drifts) drifts += (drifts.empty() ? "" : ",") + drift;
  std::string command = "bench accuracy --seeds " + options.seeds + " --drift " + drifts;
  if (options.rooms) command += format(" --rooms %d", options.rooms);
  if (options.ablation) command += " --ablation";
  if (options.slipping_feet) command += " --slipping-feet";
  if (options.closure_spacing_m > 0.0) command += format(" --closure-spacing %g", options.closure_spacing_m);
  if (!options.recordings.empty()) command += " --recordings DIR";
  if (!options.config.empty()) command += " --config FILE";
  return command + " --markdown docs/accuracy.md";
}

std::string tables(const Study& study) {
  std::string text = paper_table(study.columns) + '\n';
  for (const Column& column : study.columns) {
    const eval::Report report = report_of(column.sessions);
    text += "## Drift: " + column.drift + "\n\n" + eval::to_markdown(report) + '\n' +
            eval::association_markdown(report) + '\n' + eval::consistency_markdown(report) + '\n' +
            session_table(column.sessions) + '\n';
  }
  text += scale_table(study.columns) + '\n' + ideal_table(study.columns) + '\n';
  if (!study.ablation.empty()) text += ablation_table(study.columns[study.ablated], study.ablation) + '\n';
  if (!study.slipping.empty()) text += slipping_table(study.slipping) + '\n';
  if (!study.sparse.empty()) text += sparse_text(study.sparse) + '\n';
  return text + nothing_text(study);
}

Json json_of(const std::vector<Session>& sessions) {
  Json json = eval::to_json(report_of(sessions));
  for (const Session& session : sessions) {
    Json row = {{"seed", session.sim.seed},
                {"sloppiness", session.sim.sloppiness},
                {"duration_s", session.duration_s},
                {"loop_closures", session.map->graph.loop_closures},
                {"loop_closures_revoked", session.map->graph.loop_closures_revoked},
                {"unresolved", session.map->unresolved.size()}};
    row.update(eval::to_json(session.evaluation));
    json["seeds"].push_back(std::move(row));
  }
  return json;
}

Json json_of(const Study& study) {
  Json json;
  for (const Column& column : study.columns) json[column.drift] = json_of(column.sessions);
  for (const LeverRuns& runs : study.ablation)
    json["ablation"][runs.lever.name] = eval::to_json(report_of(runs.sessions));
  for (const SlippingFeet& runs : study.slipping) {
    json["slipping_feet"][runs.drift]["heard"] = eval::to_json(report_of(runs.heard));
    json["slipping_feet"][runs.drift]["not_heard"] = eval::to_json(report_of(runs.not_heard));
  }
  if (!study.sparse.empty()) json["few_closures"] = json_of(study.sparse);
  for (const QuietRecording& recording : study.quiet) json["recordings"][recording.name] = recording.objects;
  return json;
}

int accuracy(const Options& options) {
  StudyOptions study;
  const auto seeds = parse_seeds(options.seeds);
  if (!seeds)
    return fail("accuracy", "--seeds \"" + options.seeds + "\": expected a list such as 1-9 or 1,4,7-12", cli::kUsage);
  study.seeds = *seeds;
  study.drifts = options.drifts;
  if (options.rooms) study.sim.rooms = options.rooms;
  if (!options.config.empty()) {
    auto config = config_from_file(options.config);
    if (!config) return fail("accuracy", config.error(), cli::kUsage);
    study.config = *config;
  }
  study.ablation = options.ablation;
  study.slipping_feet = options.slipping_feet;
  study.sparse_spacing_m = options.closure_spacing_m;
  study.recordings = options.recordings;
  study.run = {.cache = options.cache, .keep = options.keep, .jobs = options.jobs, .label = ""};
  const auto result = run_study(study);
  if (!result) return fail("accuracy", result.error());
  if (!options.markdown.empty())
    if (auto error = write_document(options.markdown, *result, command_of(options)))
      return fail("accuracy", error->message);
  return print("accuracy", options.json ? pretty_text(json_of(*result)) : tables(*result));
}

}  // namespace

void add_accuracy(CLI::App& app, cli::Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = cli::add_command(
      app, run, "accuracy", "Simulate, build and evaluate many sessions: the paper's Table I and figure 6",
      "  bench accuracy --seeds 1-9\n"
      "  bench accuracy --seeds 1-40 --drift good,default,bad --ablation --slipping-feet\n"
      "                 --closure-spacing 30 --recordings DIR --markdown docs/accuracy.md\n"
      "  bench accuracy --seeds 3 --keep out --json\n",
      options, accuracy);
  command->add_option("--seeds", options->seeds, "Which sessions")->capture_default_str();
  command->add_option("--drift", options->drifts, "How bad the suit is")
      ->capture_default_str()
      ->delimiter(',')
      ->check(CLI::IsMember({"good", "default", "bad"}));
  command->add_option("--rooms", options->rooms, "Number of rooms; default: drawn from the seed")
      ->check(CLI::Range(1, 3));
  command->add_option("--config", options->config, "Configuration as for kinemapd")->type_name("FILE");
  command->add_flag("--ablation", options->ablation,
                    "Also build the default column's sessions with one part of the estimator off at a time");
  command->add_flag("--slipping-feet", options->slipping_feet,
                    "Also run the seeds with a suit that does not hold standing feet in place");
  command
      ->add_option("--closure-spacing", options->closure_spacing_m,
                   "Also run the seeds with something known touched only every so many metres: is the map still right?")
      ->check(CLI::Range(5.0, 100.0))
      ->type_name("M");
  command
      ->add_option("--recordings", options->recordings,
                   "Also build the recordings there, in which nothing is drawn and nobody sits")
      ->check(CLI::ExistingDirectory)
      ->type_name("DIR");
  command->add_option("--jobs", options->jobs, "Sessions at the same time; default: one for each core")
      ->check(CLI::Range(1, 256));
  command
      ->add_option("--cache", options->cache,
                   "Keep the simulated sessions there and use them again; clear it when the simulator changes")
      ->type_name("DIR");
  command->add_option("--keep", options->keep, "Keep each map there, in a directory of the session's name")
      ->type_name("DIR");
  command
      ->add_option("--markdown", options->markdown,
                   "Also write a document with pictures; they go into the directory of its name beside it")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print everything as JSON, with all matches of each seed");
}

}  // namespace kinemap::bench
