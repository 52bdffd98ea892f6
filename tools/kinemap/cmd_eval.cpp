// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/json_text.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/evaluation.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  std::string map;
  std::string truth;
  bool json = false;
  bool objects = false;
};

std::string spread_text(const eval::Spread& spread, int decimals, double factor = 1.0) {
  return spread.n ? format("%.*f ± %.*f", decimals, factor * spread.mean, decimals, factor * spread.std) : "";
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string class_table(const eval::Report& report) {
  std::vector<std::vector<std::string>> rows = {
      {"class", "edge error %", "n", "recall %", "precision %", "duplicates", "position m", "heading °"}};
  for (std::size_t c = 0; c < eval::kClassCount; ++c) {
    const eval::Report::PerClass& row = report.classes[c];
    if (row.counts.truth == 0 && row.counts.estimated == 0) continue;
    rows.push_back({eval::to_string(static_cast<eval::Class>(c)), spread_text(row.mape_percent, 1),
                    format("%zu/%zu", row.counts.found, row.counts.truth), format("%.0f", 100 * recall(row.counts)),
                    format("%.0f", 100 * precision(row.counts)), std::to_string(row.counts.duplicates),
                    spread_text(row.level_error_m, 2), spread_text(row.heading_error_rad, 1, kDegrees)});
  }
  rows.push_back({"all", "", format("%zu/%zu", report.total.found, report.total.truth),
                  format("%.0f", 100 * recall(report.total)), format("%.0f", 100 * precision(report.total)),
                  std::to_string(report.total.duplicates), "", ""});
  return text_table(rows, {0});
}

std::string match_table(const eval::Evaluation& evaluation) {
  std::vector<std::vector<std::string>> rows = {
      {"class", "true id", "map id", "edges %", "position m", "height m", "heading °"}};
  for (const eval::Match& match : evaluation.matches) {
    std::string edges;
    for (const double error : match.edge_errors_percent) edges += format(edges.empty() ? "%.1f" : " %.1f", error);
    rows.push_back({eval::to_string(match.klass), std::to_string(match.truth_id), std::to_string(match.object_id),
                    edges, format("%.2f", match.level_error_m), format("%+.2f", match.height_error_m),
                    format("%.1f", match.heading_error_rad * kDegrees)});
  }
  return text_table(rows, {0});
}

std::string id_list(const char* what, const std::vector<std::uint32_t>& ids) {
  if (ids.empty()) return "";
  std::string text = what;
  for (const std::uint32_t id : ids) text += " " + std::to_string(id);
  return text + '\n';
}

int evaluate_directory(const Options& options) {
  const auto map = read_map_files(options.map);
  if (!map) return fail("eval", map.error());
  if (map->trajectory.empty())
    return fail("eval", options.map + ": no trajectory; give the directory that 'kinemap build' wrote");
  const auto text = read_file(options.truth);
  if (!text) return fail("eval", text.error());
  const auto truth = eval::truth_from_text(*text);
  if (!truth) return fail("eval", options.truth + ": " + truth.error());
  const auto evaluation = eval::evaluate(*map, *truth);
  if (!evaluation) return fail("eval", evaluation.error());

  const eval::Report report = eval::summarise({*evaluation});
  if (options.json) {
    nlohmann::ordered_json json = eval::to_json(report);
    json["session"] = eval::to_json(*evaluation);
    return print("eval", pretty_text(json));
  }
  std::string output = class_table(report);
  output += id_list("missed (true ids):", evaluation->missed) + id_list("false (map ids):", evaluation->spurious) +
            id_list("duplicates (map ids):", evaluation->duplicates);
  output += format("trajectory RMSE over %zu key poses: open loop %.3f m, optimised %.3f m\n", evaluation->poses,
                   evaluation->rmse_open_loop_m, evaluation->rmse_optimised_m);
  if (options.objects) output += '\n' + match_table(*evaluation);
  return print("eval", output);
}

}  // namespace

void add_eval(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "eval", "How good is a map: the paper's measures against the truth of a simulated session",
                  "  kinemap eval map --truth session/truth.json\n"
                  "  kinemap eval map --truth session/truth.json --objects     with a line for each object\n"
                  "\nEdge error: mean absolute percentage error of the edge lengths, per object, mean ± standard "
                  "deviation (walls: length\n"
                  "only, since heights are assumed). Map and truth are aligned by heading and translation of the "
                  "trajectories; each true\n"
                  "object is matched to at most one of the map. A second object for a true one is a duplicate and "
                  "lowers the precision.",
                  options, evaluate_directory);
  command->add_option("DIR", options->map, "What 'kinemap build' wrote")->required();
  command->add_option("--truth", options->truth, "truth.json of 'kinemap sim'")->required()->type_name("FILE");
  command->add_flag("--objects", options->objects, "Add a line for each matched object");
  command->add_flag("--json", options->json, "Print everything as JSON");
}

}  // namespace kinemap::cli
