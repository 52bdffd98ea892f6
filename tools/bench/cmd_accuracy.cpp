// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/bench/accuracy.hpp"
#include "tools/bench/commands.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

using cli::fail;
using cli::format;
using cli::print;
using Json = nlohmann::ordered_json;

struct Options {
  std::string seeds = "1-9";
  std::vector<std::string> drifts = {"default"};
  std::string cache, keep, markdown, config;
  int rooms = 0;
  bool json = false;
};

std::string percent(const std::vector<double>& values) {
  return values.empty() ? "–" : format("%.1f", eval::spread_of(values).mean);
}

/// One line for each seed: mean edge errors by class, found of true, false and duplicate objects, both RMSE.
std::string session_rows(const std::vector<Session>& sessions) {
  std::string text =
      "| seed | tables % | big % | small % | walls % | chairs m | found | false | double | open loop m | optimised m | "
      "closures |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Session& session : sessions) {
    std::array<std::vector<double>, eval::kClassCount> mape;
    std::vector<double> chairs;
    for (const eval::Match& match : session.evaluation.matches) {
      mape[static_cast<std::size_t>(match.klass)].push_back(match.mape_percent());
      if (match.klass == eval::Class::Chair) chairs.push_back(match.level_error_m);
    }
    std::size_t truth = 0, found = 0;
    for (const eval::ClassCounts& counts : session.evaluation.counts) {
      truth += counts.truth;
      found += counts.found;
    }
    text += format("| %llu |", static_cast<unsigned long long>(session.seed));
    for (std::size_t c = 0; c + 1 < eval::kClassCount; ++c) text += " " + percent(mape[c]) + " |";
    text += (chairs.empty() ? std::string(" – |") : format(" %.2f |", eval::spread_of(chairs).mean));
    text += format(" %zu / %zu | %zu | %zu | %.3f | %.3f | %zu (−%zu) |\n", found, truth,
                   session.evaluation.spurious.size(), session.evaluation.duplicates.size(),
                   session.evaluation.rmse_open_loop_m, session.evaluation.rmse_optimised_m,
                   session.graph.loop_closures, session.graph.loop_closures_revoked);
  }
  return text;
}

eval::Report report_of(const std::vector<Session>& sessions) {
  std::vector<eval::Evaluation> evaluations;
  for (const Session& session : sessions) evaluations.push_back(session.evaluation);
  return eval::summarise(evaluations);
}

std::string markdown(const std::string& drift, const std::vector<Session>& sessions) {
  std::size_t better = 0;
  for (const Session& session : sessions)
    better += session.evaluation.rmse_optimised_m < session.evaluation.rmse_open_loop_m ? 1 : 0;
  const eval::Report report = report_of(sessions);
  return "## Drift: " + drift + "\n\n" + eval::to_markdown(report) + '\n' + eval::association_markdown(report) + '\n' +
         eval::consistency_markdown(report) + '\n' +
         format("The optimised trajectory is better than the open-loop one in %zu of %zu sessions.\n\n", better,
                sessions.size()) +
         session_rows(sessions) + '\n';
}

Json json_of(const std::vector<Session>& sessions) {
  Json json = eval::to_json(report_of(sessions));
  for (const Session& session : sessions) {
    Json row = {{"seed", session.seed},
                {"duration_s", session.duration_s},
                {"build_s", session.build_s},
                {"loop_closures", session.graph.loop_closures},
                {"loop_closures_revoked", session.graph.loop_closures_revoked},
                {"unresolved", session.unresolved}};
    row.update(eval::to_json(session.evaluation));
    json["seeds"].push_back(std::move(row));
  }
  return json;
}

int accuracy(const Options& options) {
  AccuracyOptions run;
  const auto seeds = parse_seeds(options.seeds);
  if (!seeds)
    return fail("accuracy", "--seeds \"" + options.seeds + "\": expected a list such as 1-9 or 1,4,7-12", cli::kUsage);
  run.seeds = *seeds;
  run.cache = options.cache;
  if (options.rooms) run.sim.rooms = options.rooms;
  if (!options.config.empty()) {
    auto config = config_from_file(options.config);
    if (!config) return fail("accuracy", config.error(), cli::kUsage);
    run.config = *config;
  }
  std::string text;
  Json json;
  for (const std::string& drift : options.drifts) {
    run.sim.drift = *sim::severity_from(drift);
    if (!options.keep.empty()) run.keep = options.drifts.size() > 1 ? options.keep + "/" + drift : options.keep;
    const auto sessions = run_accuracy(run);
    if (!sessions) return fail("accuracy", sessions.error());
    text += markdown(drift, *sessions);
    json[drift] = json_of(*sessions);
  }
  if (!options.markdown.empty()) {
    const std::string head =
        "# Accuracy\n\nMade by `bench accuracy --seeds " + options.seeds +
        "`: simulated wearers, built by the same pipeline as live, against the simulator's truth. Edge "
        "error: mean absolute percentage error of the edge lengths of an object (walls: length only), mean ± "
        "standard deviation over objects. Position and heading: after aligning the trajectories by heading "
        "and translation; walls across the wall. tools/kinemap/evaluation.hpp has the definitions.\n\n";
    if (auto error = cli::write_file(options.markdown, head + text)) return fail("accuracy", error->message);
  }
  return print("accuracy", options.json ? pretty_text(json) : text);
}

}  // namespace

void add_accuracy(CLI::App& app, cli::Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = cli::add_command(
      app, run, "accuracy", "Simulate, build and evaluate many sessions: the paper's Table I and figure 6",
      "  bench accuracy --seeds 1-9\n"
      "  bench accuracy --seeds 1-20 --drift good,default,bad --cache /tmp/sessions --markdown docs/accuracy.md\n"
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
  command
      ->add_option("--cache", options->cache,
                   "Keep the simulated sessions there and use them again; clear it when the simulator changes")
      ->type_name("DIR");
  command->add_option("--keep", options->keep, "Keep each map in DIR/seedN")->type_name("DIR");
  command->add_option("--markdown", options->markdown, "Also write the tables into a file")->type_name("FILE");
  command->add_flag("--json", options->json, "Print everything as JSON, with all matches of each seed");
}

}  // namespace kinemap::bench
