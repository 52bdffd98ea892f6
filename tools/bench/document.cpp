// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/document.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/bench/charts.hpp"
#include "tools/bench/session_drawing.hpp"
#include "tools/bench/tables.hpp"
#include "tools/bench/worst_cases.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWorstCases = 5;
constexpr std::size_t kWorstOfOne = 3;

/// The Markdown in the making, and the pictures that it refers to.
class Document {
 public:
  explicit Document(const std::string& path) : path_(path), pictures_(fs::path(path).replace_extension()) {}

  void add(const std::string& markdown) { text_ += markdown; }

  void picture(const std::string& name, const std::string& alt, const std::string& svg) {
    svgs_.emplace_back(name + ".svg", svg);
    text_ += "![" + alt + "](" + pictures_.filename().string() + "/" + name + ".svg)\n\n";
  }

  /// Text that a reader may open.
  void details(const std::string& summary, const std::string& markdown) {
    text_ += "<details><summary>" + summary + "</summary>\n\n" + markdown + "\n</details>\n\n";
  }

  /// Hand-written sentences by the name of their case; empty when there is no such file.
  [[nodiscard]] Result<nlohmann::json> notes() const {
    const fs::path file = pictures_ / "notes.json";
    if (!fs::exists(file)) return nlohmann::json::object();
    const auto text = cli::read_file(file.string());
    if (!text) return Error{text.error()};
    auto json = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) return Error{file.string() + ": expected an object of sentences"};
    return json;
  }

  /// Old pictures are removed: a worst case that is none any more leaves none behind.
  std::optional<Error> write() const {
    if (auto error = cli::make_output_directory(pictures_.string())) return error;
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(pictures_, code))
      if (entry.path().extension() == ".svg") fs::remove(entry.path(), code);
    for (const auto& [name, svg] : svgs_)
      if (auto error = cli::write_file((pictures_ / name).string(), svg)) return error;
    return cli::write_file(path_, text_);
  }

 private:
  std::string path_;
  fs::path pictures_;
  std::string text_;
  std::vector<std::pair<std::string, std::string>> svgs_;
};

void opening(Document& document, const Study& study, const std::string& command) {
  document.add(
      "# Accuracy\n\nSimulated wearers in simulated rooms, whose truth is known, seen through suits that go wrong by "
      "the "
      "three columns of the table of suit drift (good: a modern engine; default: the office of 2015; bad: everything "
      "twice as bad) and built by the same code as live. The simulator (`tools/sim`) shares no code with the "
      "estimator. "
      "This page and its pictures come out of\n\n```\n" +
      command + "\n```\n\n" + coverage_text(study) +
      "\nEdge error: mean absolute percentage error of the edge lengths of an object (a wall's length only: its height "
      "is "
      "assumed), then mean ± standard deviation over objects. Positions and headings: after aligning the trajectories "
      "by "
      "heading and translation; walls across the wall. A second object for one that is there counts as a duplicate and "
      "lowers the precision. `tools/kinemap/evaluation.hpp` has the definitions.\n\n");
}

void results(Document& document, const Study& study) {
  document.add("## The paper's Table I, and ours\n\n");
  document.picture("table", "Edge errors by class beside the paper's", table_chart(study.columns));
  document.add(paper_table(study.columns));
  document.add("\n## The paper's figure 6: trajectories\n\n");
  document.picture("trajectory", "Trajectory error of each session", trajectory_chart(study.columns));
  document.add("The paper gives its figure without numbers: nine sessions, each better optimised than open loop. " +
               better_text(study.columns) + "\n\n");
  for (const Column& column : study.columns) {
    const eval::Report report = report_of(column.sessions);
    document.add("## Drift: " + column.drift + "\n\n" + eval::to_markdown(report) + '\n' +
                 eval::association_markdown(report) + '\n');
    document.details("Session by session", session_table(column.sessions));
  }
}

void consistency(Document& document, const Study& study) {
  document.add(
      "## Is the uncertainty true?\n\nEach error over the sigma that the map itself reports for it (edges of sizes; x "
      "and y "
      "of positions, walls across; headings). Sigmas are relative to the first pose of the session, so the map is laid "
      "onto the truth there. Were the errors normal and the sigmas right, 68 % would lie within 1 σ and 95 % within 2 "
      "σ.\n\n");
  for (const Column& column : study.columns) {
    document.picture("consistency-" + column.drift, "Errors within the reported sigmas", consistency_chart(column));
    document.details("Numbers, " + column.drift + " drift", eval::consistency_markdown(report_of(column.sessions)));
  }
}

void limits(Document& document, const Study& study) {
  document.add(
      "## What the suit does not tell\n\nWhere a wall ends: that is where it meets the next, and when nobody ever "
      "touched "
      "the next, its end can only be inferred. And scale: a closed loop that is a little too long is still a closed "
      "loop, "
      "so no closure sees a wrong step length; the last column takes the scale of each session's trajectory (true over "
      "estimated extent) out of its walls.\n\n" +
      scale_table(study.columns) + '\n');
  document.add(
      "What the hand does not tell: the arm errs by centimetres for seconds, and metal turns the heading while one "
      "draws. The ideal estimator is the best linear unbiased one, given what nobody knows: the point that touches, "
      "when the hand touches and along which side, and the covariance of all errors of the column "
      "(`tools/bench/ideal.hpp`). It has each gesture by itself, with the way as the suit reports it, then with the "
      "true one: loops that close can bring a map from the one towards the other, not beyond. Only screens and tables "
      "of which one gesture drew all four sides.\n\n" +
      ideal_table(study.columns) + '\n');
}

void ablation(Document& document, const Study& study) {
  if (study.ablation.empty()) return;
  const Column& full = study.columns[study.ablated];
  document.add("## What each part brings\n\nOne at a time switched off, the same " +
               std::to_string(full.sessions.size()) + " sessions (" + full.drift + " drift).\n\n");
  document.picture("ablation", "Errors with one part at a time switched off", ablation_chart(full, study.ablation));
  document.add(ablation_table(full, study.ablation) + '\n');
}

void describe(Document& document, const std::vector<WorstCase>& cases, const nlohmann::json& notes) {
  for (const WorstCase& one : cases) {
    const std::string name = case_name(one);
    document.add(format("### %.0f %%: %s drift, seed %llu, %s %u\n\n", one.match->mape_percent(), one.drift.c_str(),
                        static_cast<unsigned long long>(one.session->sim.seed), eval::to_string(one.match->klass),
                        one.match->truth_id));
    document.add(explain(one) + "\n\n");
    if (notes.contains(name)) document.add(notes[name].get<std::string>() + "\n\n");
    document.picture("worst-" + name, "Floor plan of the session", session_svg(*one.session, one.match->truth_id));
  }
}

std::optional<Error> worst(Document& document, const Study& study) {
  const auto notes = document.notes();
  if (!notes) return Error{notes.error()};
  document.add(
      "## The worst five\n\nThe largest relative errors of all sessions, one from each seed at most. Truth in grey "
      "beneath the map; the object in question is underlined.\n\n");
  const auto cases = worst_cases(study.columns, kWorstCases);
  describe(document, cases, *notes);
  const Column& usual = study.columns[study.ablated];
  auto more = worst_cases(std::span(&usual, 1), kWorstOfOne);
  std::erase_if(more, [&](const WorstCase& one) {
    return std::any_of(cases.begin(), cases.end(), [&](const WorstCase& shown) { return shown.match == one.match; });
  });
  if (more.empty()) return std::nullopt;
  document.add("## The worst of the " + usual.drift + " column\n\n");
  describe(document, more, *notes);
  return std::nullopt;
}

void robustness(Document& document, const Study& study) {
  if (!study.slipping.empty())
    document.add(
        "## When standing feet slip\n\nMVN holds a foot that stands where it is, and the simulated suits above do as "
        "well. Of a suit that does not, standing feet tell how it slips as a whole (`docs/method.md`). The same seeds "
        "with such suits, whose legs err by a quarter of what their arms do:\n\n" +
        slipping_table(study.slipping) + '\n');
  if (!study.sparse.empty())
    document.add(format("## With closures only every %.0f m\n\n", study.sparse_spacing_m) + sparse_text(study.sparse) +
                 '\n');
  document.add("## Nothing out of nothing\n\n" + nothing_text(study));
}

}  // namespace

std::optional<Error> write_document(const std::string& path, const Study& study, const std::string& command) {
  Document document(path);
  opening(document, study, command);
  results(document, study);
  consistency(document, study);
  limits(document, study);
  ablation(document, study);
  if (auto error = worst(document, study)) return error;
  robustness(document, study);
  return document.write();
}

}  // namespace kinemap::bench
