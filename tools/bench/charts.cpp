// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/bench/svg.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

using Point = Eigen::Vector2d;

constexpr double kWidth = 860.0;

const char* colour_of(const std::string& drift) {
  if (drift == "good") return colour::kGreen;
  if (drift == "bad") return colour::kVermilion;
  return colour::kBlue;
}

/// A linear scale from values to pixels.
struct Axis {
  double low, high;  ///< values
  double from, to;   ///< pixels
  [[nodiscard]] double operator()(double value) const { return from + (value - low) / (high - low) * (to - from); }
};

/// Horizontal grid lines with numbers at their left.
void level_grid(Svg& svg, const Axis& y, double left, double right, const char* pattern, int count = 5) {
  const double step = nice_step(y.high - y.low, count);
  for (double value = y.low; value <= y.high + 1e-9; value += step) {
    svg.line({left, y(value)}, {right, y(value)}, {colour::kGrid});
    svg.text({left - 6, y(value) + 4}, format(pattern, value), {.size = 12, .colour = colour::kFaint, .anchor = "end"});
  }
}

struct LegendItem {
  std::string words;
  const char* colour;
};

/// Squares with words, one after the other.
void legend(Svg& svg, Point at, const std::vector<LegendItem>& items) {
  for (const LegendItem& item : items) {
    svg.box(at + Point(0, -10), at + Point(12, 2), item.colour);
    svg.text(at + Point(17, 0), item.words, {});
    at.x() += 36 + 7.0 * static_cast<double>(cli::display_width(item.words));
  }
}

const char* plural(eval::Class klass) {
  constexpr const char* kNames[] = {"Tables", "Big screens", "Small screens", "Walls", "Chairs"};
  return kNames[static_cast<std::size_t>(klass)];
}

struct Bar {
  double mean, std;
  std::size_t n;
  const char* colour;
};

void draw_bar(Svg& svg, const Axis& y, double left, double width, const Bar& bar) {
  const double middle = left + width / 2;
  svg.box({left, y(bar.mean)}, {left + width, y(0)}, bar.colour);
  const double top = std::min(bar.mean + bar.std, y.high), bottom = std::max(0.0, bar.mean - bar.std);
  svg.line({middle, y(bottom)}, {middle, y(top)}, {.width = 1.5});
  for (const double end : {bar.mean + bar.std, bottom})
    if (end <= y.high) svg.line({middle - 5, y(end)}, {middle + 5, y(end)}, {.width = 1.5});
  svg.text({middle, y(top) - 7}, format("%.1f", bar.mean),
           {.size = 12, .anchor = "middle", .bold = true, .halo = true});
  svg.text({middle, y(0) + 14}, format("%zu", bar.n), {.size = 10.5, .colour = colour::kFaint, .anchor = "middle"});
}

}  // namespace

std::string table_chart(const std::vector<Column>& columns) {
  constexpr double kHeight = 380.0, kLeft = 46.0, kTop = 70.0, kBottom = 320.0;
  constexpr double kHighest = 45.0;  // %: bars beyond are cut off, without an end
  Svg svg(kWidth, kHeight, "Edge length errors by class, beside the paper's Table I");
  std::vector<eval::Report> reports;
  std::vector<LegendItem> items = {{"paper, Table I", colour::kGrey}};
  double highest = 0.0;
  for (const PaperRow& row : kPaper) highest = std::max(highest, row.mean + row.std);
  for (const Column& column : columns) {
    reports.push_back(report_of(column.sessions));
    items.push_back({"Kinemap, " + column.drift + " drift", colour_of(column.drift)});
    for (const PaperRow& row : kPaper) {
      const auto& spread = reports.back().classes[static_cast<std::size_t>(row.klass)].mape_percent;
      highest = std::max(highest, std::min(spread.mean + spread.std, kHighest));
    }
  }
  svg.text({kLeft, 22}, "Error of edge lengths, % (mean, bar: ± 1 standard deviation over objects)",
           {.size = 14, .bold = true});
  legend(svg, {kLeft, 46}, items);
  const Axis y{0.0, std::ceil(highest / 5.0) * 5.0, kBottom, kTop};
  level_grid(svg, y, kLeft, kWidth - 10, "%.0f");
  const double group = (kWidth - 10 - kLeft) / std::size(kPaper),
               width = 0.8 * group / static_cast<double>(columns.size() + 1);
  for (std::size_t g = 0; g < std::size(kPaper); ++g) {
    const PaperRow& row = kPaper[g];
    const double left = kLeft + group * (static_cast<double>(g) + 0.1);
    draw_bar(svg, y, left + 2, width - 4, {row.mean, row.std, row.n, colour::kGrey});
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto& spread = reports[c].classes[static_cast<std::size_t>(row.klass)].mape_percent;
      if (spread.n == 0) continue;
      draw_bar(svg, y, left + width * static_cast<double>(c + 1) + 2, width - 4,
               {spread.mean, spread.std, spread.n, colour_of(columns[c].drift)});
    }
    svg.text({left + 0.4 * group, kBottom + 34}, plural(row.klass), {.size = 14, .anchor = "middle", .bold = true});
  }
  svg.text({kLeft - 6, kBottom + 14}, "n", {.size = 10.5, .colour = colour::kFaint, .anchor = "end"});
  svg.line({kLeft, kBottom}, {kWidth - 10, kBottom}, {});
  return svg.str();
}

namespace {

/// Open loop (hollow) over optimised (filled), sessions in the order of their open-loop error.
void trajectory_panel(Svg& svg, const Column& column, double left, double right) {
  constexpr double kTop = 92.0, kBottom = 300.0;
  auto sessions = column.sessions;
  std::sort(sessions.begin(), sessions.end(), [](const Session& a, const Session& b) {
    return a.evaluation.rmse_open_loop_m < b.evaluation.rmse_open_loop_m;
  });
  double highest = 0.0;
  for (const Session& session : sessions)
    highest = std::max({highest, session.evaluation.rmse_open_loop_m, session.evaluation.rmse_optimised_m});
  const double step = nice_step(1.05 * highest, 5);
  const Axis y{0.0, step * std::ceil(1.05 * highest / step), kBottom, kTop};
  const Axis x{-1.0, static_cast<double>(sessions.size()), left, right};
  level_grid(svg, y, left, right, "%.2g");
  const char* colour = colour_of(column.drift);
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const double at = x(static_cast<double>(i)), open = y(sessions[i].evaluation.rmse_open_loop_m),
                 optimised = y(sessions[i].evaluation.rmse_optimised_m);
    svg.line({at, open}, {at, optimised}, {.colour = colour, .width = 1.2, .opacity = 0.45});
    svg.dot({at, open}, 2.8, "#fff", {.colour = colour::kFaint, .width = 1.2});
    svg.dot({at, optimised}, 2.8, colour, {.colour = colour, .width = 0.8});
  }
  const eval::Report report = report_of(sessions);
  svg.text({left, kTop - 26}, column.drift + " drift", {.size = 14, .colour = colour, .bold = true});
  svg.text({left, kTop - 10}, format("mean %.2f → %.2f m", report.rmse_open_loop_m.mean, report.rmse_optimised_m.mean),
           {.size = 12});
  svg.text({(left + right) / 2, kBottom + 18}, format("%zu sessions", sessions.size()),
           {.size = 12, .colour = colour::kFaint, .anchor = "middle"});
  svg.line({left, kBottom}, {right, kBottom}, {});
}

}  // namespace

std::string trajectory_chart(const std::vector<Column>& columns) {
  Svg svg(kWidth, 330, "Trajectory error open loop and optimised, session by session");
  svg.text({12, 22}, "RMSE of the trajectory, m, session by session (ordered by the open-loop error)",
           {.size = 14, .bold = true});
  svg.dot({18, 42}, 3.5, "#fff", {.colour = colour::kFaint, .width = 1.3});
  svg.text({28, 46}, "open loop: the suit alone", {});
  svg.dot({208, 42}, 3.5, colour::kInk, {});
  svg.text({218, 46}, "optimised", {});
  const double width = (kWidth - 10) / static_cast<double>(columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double left = width * static_cast<double>(c);
    trajectory_panel(svg, columns[c], left + 44, left + width - 8);
  }
  return svg.str();
}

namespace {

/// The five figures of a run that the ablation looks at; NaN where there is nothing to measure.
std::array<double, 5> figures(const std::vector<Session>& sessions) {
  const eval::Report report = report_of(sessions);
  std::array<double, 5> out{};
  for (std::size_t c = 0; c < 4; ++c)
    out[c] = report.classes[c].mape_percent.n ? report.classes[c].mape_percent.mean : std::nan("");
  out[4] = report.rmse_optimised_m.mean;
  return out;
}

}  // namespace

std::string ablation_chart(const Column& full, const std::vector<LeverRuns>& ablation) {
  constexpr double kLeft = 196.0, kTop = 78.0, kRow = 27.0;
  constexpr const char* kTitles[] = {"tables %", "big screens %", "small screens %", "walls %", "trajectory m"};
  const double height = kTop + kRow * static_cast<double>(ablation.size() + 1) + 14;
  Svg svg(kWidth, height, "Errors with each lever off");
  svg.text({12, 22}, "Mean error with one thing at a time switched off (" + full.drift + " drift)",
           {.size = 14, .bold = true});
  legend(svg, {12, 46}, {{"everything on", colour::kBlue}, {"worse", colour::kOrange}, {"no worse", colour::kGrey}});
  std::vector<std::array<double, 5>> rows = {figures(full.sessions)};
  for (const LeverRuns& runs : ablation) rows.push_back(figures(runs.sessions));
  const double panel = (kWidth - kLeft - 6) / 5;
  for (std::size_t p = 0; p < 5; ++p) {
    const double left = kLeft + panel * static_cast<double>(p);
    double highest = 0.0;
    for (const auto& row : rows)
      if (std::isfinite(row[p])) highest = std::max(highest, row[p]);
    if (highest <= 0.0) continue;
    const Axis x{0.0, highest, left, left + panel - 52};
    svg.text({left, kTop - 8}, kTitles[p], {.size = 12, .bold = true});
    svg.line({x(rows[0][p]), kTop}, {x(rows[0][p]), height - 12},
             {.colour = colour::kBlue, .width = 1, .dashes = "3 3"});
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (!std::isfinite(rows[r][p])) continue;
      const double top = kTop + kRow * static_cast<double>(r) + 4;
      const bool worse = rows[r][p] > rows[0][p] * 1.02;
      const char* colour = r == 0 ? colour::kBlue : worse ? colour::kOrange : colour::kGrey;
      svg.box({left, top}, {x(rows[r][p]), top + kRow - 9}, colour);
      svg.text({x(rows[r][p]) + 5, top + 14}, format(p == 4 ? "%.3f" : "%.1f", rows[r][p]), {.size = 12});
    }
  }
  svg.text({kLeft - 10, kTop + 18}, "everything on", {.anchor = "end", .bold = true});
  for (std::size_t r = 0; r < ablation.size(); ++r)
    svg.text({kLeft - 10, kTop + kRow * static_cast<double>(r + 1) + 18}, ablation[r].lever.name,
             {.size = 12, .anchor = "end"});
  return svg.str();
}

namespace {

struct Quantity {
  const char* name;
  std::vector<double> eval::NormalisedErrors::*errors;
};
constexpr Quantity kQuantities[] = {{"size", &eval::NormalisedErrors::size},
                                    {"position", &eval::NormalisedErrors::position},
                                    {"heading", &eval::NormalisedErrors::heading}};

}  // namespace

std::string consistency_chart(const Column& column) {
  constexpr double kLeft = 190.0, kRight = kWidth - 60.0, kTop = 84.0, kRow = 22.0;
  const eval::Report report = report_of(column.sessions);
  std::vector<std::pair<std::string, eval::Consistency>> rows;
  for (std::size_t c = 0; c < eval::kClassCount; ++c)
    for (const Quantity& quantity : kQuantities) {
      const auto result = eval::consistency_of(report.classes[c].normalised.*quantity.errors);
      if (result.n) rows.emplace_back(std::string(plural(static_cast<eval::Class>(c))) + ", " + quantity.name, result);
    }
  const double bottom = kTop + kRow * static_cast<double>(rows.size());
  Svg svg(kWidth, bottom + 34, "Share of errors within one and two reported sigmas");
  svg.text({12, 22}, "Share of errors within the reported uncertainty, % (" + column.drift + " drift)",
           {.size = 14, .bold = true});
  svg.dot({18, 42}, 4.5, colour::kBlue, {.colour = colour::kBlue});
  svg.text({28, 46}, "within 1 σ, wanted 68 ± 7", {});
  svg.dot({218, 42}, 4.5, colour::kOrange, {.colour = colour::kOrange});
  svg.text({228, 46}, "within 2 σ, wanted 95 ± 7", {});
  const Axis x{0.0, 100.0, kLeft, kRight};
  svg.box({x(61), kTop}, {x(75), bottom}, colour::kBlue, 0.13);
  svg.box({x(88), kTop}, {x(100), bottom}, colour::kOrange, 0.16);
  for (double value = 0; value <= 100; value += 20) {
    svg.line({x(value), kTop}, {x(value), bottom}, {colour::kGrid});
    svg.text({x(value), bottom + 18}, format("%.0f", value),
             {.size = 12, .colour = colour::kFaint, .anchor = "middle"});
  }
  svg.text({kRight + 12, kTop - 8}, "n", {.size = 12, .colour = colour::kFaint});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto& [name, result] = rows[r];
    const double y = kTop + kRow * (static_cast<double>(r) + 0.5);
    svg.text({kLeft - 10, y + 4}, name, {.anchor = "end"});
    svg.line({x(100 * result.within_1), y}, {x(100 * result.within_2), y}, {.colour = colour::kGrey, .width = 1.2});
    svg.dot({x(100 * result.within_1), y}, 5, colour::kBlue, {.colour = "#fff"});
    svg.dot({x(100 * result.within_2), y}, 5, colour::kOrange, {.colour = "#fff"});
    svg.text({kRight + 12, y + 4}, format("%zu", result.n), {.size = 12, .colour = colour::kFaint});
  }
  return svg.str();
}

}  // namespace kinemap::bench
