// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <numbers>

#include "tools/kinemap/evaluation.hpp"

namespace kinemap::eval {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string text(const char* format, auto... values) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string spread_text(const Spread& spread, const char* format, double factor = 1.0) {
  return spread.n ? text(format, factor * spread.mean, factor * spread.std) : "–";
}

std::string class_row(const char* name, const Report::PerClass& row, bool edges) {
  const ClassCounts& counts = row.counts;
  return "| " + std::string(name) + " | " + (edges ? spread_text(row.mape_percent, "%.1f ± %.1f") : "–") + " | " +
         (edges && row.mape_percent.n ? text("%.1f", row.mape_percent.median) : "–") + " | " +
         text("%zu / %zu", counts.found, counts.truth) + " | " + text("%.1f", 100 * recall(counts)) + " | " +
         text("%.1f", 100 * precision(counts)) + " | " + text("%zu", counts.duplicates) + " | " +
         spread_text(row.level_error_m, "%.2f ± %.2f") + " | " +
         spread_text(row.heading_error_rad, "%.1f ± %.1f", kDegrees) + " |\n";
}

std::string consistency_row(const char* klass, const char* what, const std::vector<double>& normalised) {
  const Consistency c = consistency_of(normalised);
  if (c.n == 0) return "";
  return "| " + std::string(klass) + " | " + what + " | " +
         text("%zu | %.0f | %.0f | %+.2f | %.2f |\n", c.n, 100 * c.within_1, 100 * c.within_2, c.mean, c.rms);
}

}  // namespace

std::string to_markdown(const Report& report) {
  std::string table =
      "| class | edge error % | median % | found | recall % | precision % | duplicates | position m | heading ° |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t c = 0; c < kClassCount; ++c) {
    const auto klass = static_cast<Class>(c);
    table += class_row(to_string(klass), report.classes[c], klass != Class::Chair);
  }
  Report::PerClass all;
  all.counts = report.total;
  table += class_row("all", all, false);
  table += "\nTrajectory RMSE: open loop " + spread_text(report.rmse_open_loop_m, "%.3f ± %.3f m") + ", optimised " +
           spread_text(report.rmse_optimised_m, "%.3f ± %.3f m") + text(" (%zu sessions)\n", report.sessions);
  return table;
}

std::string consistency_markdown(const Report& report) {
  std::string table =
      "| class | error over its sigma | n | within 1 σ % | within 2 σ % | mean | rms |\n"
      "|---|---|---|---|---|---|---|\n"
      "| *wanted* | | | *68* | *95* | *0* | *1* |\n";
  for (std::size_t c = 0; c < kClassCount; ++c) {
    const char* name = to_string(static_cast<Class>(c));
    const NormalisedErrors& errors = report.classes[c].normalised;
    table += consistency_row(name, "size", errors.size);
    table += consistency_row(name, "position", errors.position);
    table += consistency_row(name, "heading", errors.heading);
    table += consistency_row(name, "position, aligned", errors.aligned_position);
    table += consistency_row(name, "heading, aligned", errors.aligned_heading);
  }
  return table;
}

std::string association_markdown(const Report& report) {
  const AssociationCounts& a = report.association;
  return text("Of %zu visits %zu hang on the wrong object (wrong closures that survived); ", a.visits, a.wrong) +
         text(
             "%zu objects are second ones for the same thing, %zu stand for nothing, %zu lie where another object "
             "is.\n",
             a.split, a.phantom, a.misplaced);
}

}  // namespace kinemap::eval
