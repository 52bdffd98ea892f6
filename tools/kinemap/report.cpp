// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "tools/kinemap/evaluation.hpp"

namespace kinemap::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

ClassCounts& operator+=(ClassCounts& a, const ClassCounts& b) {
  a.truth += b.truth;
  a.found += b.found;
  a.estimated += b.estimated;
  a.duplicates += b.duplicates;
  return a;
}

Json spread_json(const Spread& spread, double factor = 1.0) {
  Json json = {{"n", spread.n}};
  if (spread.n == 0) return json;
  for (const auto& [key, value] : {std::pair{"mean", spread.mean}, std::pair{"std", spread.std},
                                   std::pair{"median", spread.median}, std::pair{"max", spread.max}})
    json[key] = rounded(factor * value);
  return json;
}

Json counts_json(const ClassCounts& counts) {
  return {{"truth", counts.truth},
          {"found", counts.found},
          {"estimated", counts.estimated},
          {"duplicates", counts.duplicates},
          {"recall", rounded(recall(counts))},
          {"precision", rounded(precision(counts))}};
}

Json to_json(const Consistency& consistency) {
  if (consistency.n == 0) return {{"n", 0}};
  return {{"n", consistency.n},
          {"within_1_sigma", rounded(consistency.within_1)},
          {"within_2_sigma", rounded(consistency.within_2)},
          {"mean", rounded(consistency.mean)},
          {"rms", rounded(consistency.rms)}};
}

Json consistency_json(const NormalisedErrors& errors, bool edges) {
  Json json;
  if (edges) json["size"] = to_json(consistency_of(errors.size));
  json["position"] = to_json(consistency_of(errors.position));
  json["heading"] = to_json(consistency_of(errors.heading));
  json["aligned_position"] = to_json(consistency_of(errors.aligned_position));
  json["aligned_heading"] = to_json(consistency_of(errors.aligned_heading));
  return json;
}

Json list_json(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(rounded(value));
  return list;
}

Json to_json(const NormalisedErrors& errors) {
  Json json;
  if (!errors.size.empty()) json["size"] = list_json(errors.size);
  json["position"] = list_json(errors.position);
  json["heading"] = list_json(errors.heading);
  json["aligned_position"] = list_json(errors.aligned_position);
  json["aligned_heading"] = list_json(errors.aligned_heading);
  return json;
}

Json to_json(const AssociationCheck& check) {
  Json wrong = Json::array();
  for (const WrongVisit& visit : check.wrong) {
    Json row = {{"object_id", visit.object_id}, {"truth_id", visit.owner_id}};
    if (visit.visited_id) row["visited_truth_id"] = *visit.visited_id;
    row["begin_s"] = rounded(visit.visit.begin_s);
    row["end_s"] = rounded(visit.visit.end_s);
    wrong.push_back(std::move(row));
  }
  return {{"visits", check.visits},
          {"wrong_visits", std::move(wrong)},
          {"split", check.split},
          {"phantom", check.phantom},
          {"misplaced", check.misplaced}};
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  Spread spread;
  spread.n = values.size();
  if (values.empty()) return spread;
  const double n = static_cast<double>(values.size());
  spread.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : values) sum += (value - spread.mean) * (value - spread.mean);
  spread.std = values.size() > 1 ? std::sqrt(sum / (n - 1)) : 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  spread.median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
  spread.max = values.back();
  return spread;
}

double recall(const ClassCounts& counts) {
  return counts.truth ? static_cast<double>(counts.found) / static_cast<double>(counts.truth) : 1.0;
}

double precision(const ClassCounts& counts) {
  return counts.estimated ? static_cast<double>(counts.found) / static_cast<double>(counts.estimated) : 1.0;
}

Report summarise(const std::vector<Evaluation>& sessions) {
  Report report;
  report.sessions = sessions.size();
  std::array<std::vector<double>, kClassCount> mape, level, heading;
  std::vector<double> open_loop, optimised;
  for (const Evaluation& session : sessions) {
    for (std::size_t c = 0; c < kClassCount; ++c) {
      report.classes[c].counts += session.counts[c];
      report.total += session.counts[c];
    }
    for (const Match& match : session.matches) {
      const auto c = static_cast<std::size_t>(match.klass);
      if (!match.edge_errors_percent.empty()) mape[c].push_back(match.mape_percent());
      level[c].push_back(match.level_error_m);
      heading[c].push_back(match.heading_error_rad);
      report.classes[c].normalised.add(match.normalised);
    }
    report.association.add(session.association);
    report.topology_right += session.topology.right() ? 1 : 0;
    open_loop.push_back(session.rmse_open_loop_m);
    optimised.push_back(session.rmse_optimised_m);
  }
  for (std::size_t c = 0; c < kClassCount; ++c) {
    report.classes[c].mape_percent = spread_of(mape[c]);
    report.classes[c].level_error_m = spread_of(level[c]);
    report.classes[c].heading_error_rad = spread_of(heading[c]);
  }
  report.rmse_open_loop_m = spread_of(open_loop);
  report.rmse_optimised_m = spread_of(optimised);
  return report;
}

Json to_json(const Report& report) {
  Json json = {{"sessions", report.sessions}};
  for (std::size_t c = 0; c < kClassCount; ++c) {
    const Report::PerClass& row = report.classes[c];
    Json& entry = json["classes"][to_string(static_cast<Class>(c))] = counts_json(row.counts);
    if (static_cast<Class>(c) != Class::Chair) entry["mape_percent"] = spread_json(row.mape_percent);
    entry["position_error_m"] = spread_json(row.level_error_m);
    entry["heading_error_deg"] = spread_json(row.heading_error_rad, kDegrees);
    entry["normalised_errors"] = consistency_json(row.normalised, static_cast<Class>(c) != Class::Chair);
  }
  json["all"] = counts_json(report.total);
  const AssociationCounts& association = report.association;
  json["association"] = {{"visits", association.visits},
                         {"wrong_visits", association.wrong},
                         {"split", association.split},
                         {"phantom", association.phantom},
                         {"misplaced", association.misplaced}};
  json["topology_right"] = report.topology_right;
  json["trajectory"] = {{"rmse_open_loop_m", spread_json(report.rmse_open_loop_m)},
                        {"rmse_optimised_m", spread_json(report.rmse_optimised_m)}};
  return json;
}

Json to_json(const Evaluation& evaluation) {
  Json json = {{"poses", evaluation.poses},
               {"rmse_open_loop_m", rounded(evaluation.rmse_open_loop_m)},
               {"rmse_optimised_m", rounded(evaluation.rmse_optimised_m)},
               {"scale", rounded(evaluation.scale)},
               {"matches", Json::array()}};
  for (const Match& match : evaluation.matches) {
    Json row = {{"truth_id", match.truth_id}, {"object_id", match.object_id}, {"class", to_string(match.klass)}};
    if (!match.edge_errors_percent.empty()) row["edge_errors_percent"] = list_json(match.edge_errors_percent);
    row["position_error_m"] = rounded(match.level_error_m);
    row["height_error_m"] = rounded(match.height_error_m);
    row["heading_error_deg"] = rounded(kDegrees * match.heading_error_rad);
    row["normalised_errors"] = to_json(match.normalised);
    json["matches"].push_back(std::move(row));
  }
  json["missed"] = evaluation.missed;
  json["spurious"] = evaluation.spurious;
  json["duplicates"] = evaluation.duplicates;
  json["association"] = to_json(evaluation.association);
  json["topology"] = {{"rooms", evaluation.topology.rooms},
                      {"rooms_found", evaluation.topology.rooms_found},
                      {"right", evaluation.topology.right()},
                      {"wrong", evaluation.topology.wrong}};
  return json;
}

}  // namespace kinemap::eval
