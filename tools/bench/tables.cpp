// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

std::string percent(const eval::Spread& spread) {
  return spread.n ? format("%.1f ± %.1f", spread.mean, spread.std) : "–";
}
std::string mean_percent(const eval::Spread& spread) { return spread.n ? format("%.1f", spread.mean) : "–"; }

std::string cell(const std::string& words) { return format(" %s |", words.c_str()); }

const eval::Spread& edge_errors(const eval::Report& report, eval::Class klass) {
  return report.classes[static_cast<std::size_t>(klass)].mape_percent;
}

/// Mean edge error of each class in one session, and of its chairs' positions.
std::string session_row(const Session& session) {
  const eval::Evaluation& e = session.evaluation;
  const eval::Report report = eval::summarise({e});
  std::string row =
      format("| %llu | %.2f |", static_cast<unsigned long long>(session.sim.seed), session.sim.sloppiness);
  for (const PaperRow& paper : kPaper) row += cell(mean_percent(edge_errors(report, paper.klass)));
  const eval::Spread& chairs = report.classes[static_cast<std::size_t>(eval::Class::Chair)].level_error_m;
  row += chairs.n ? format(" %.2f |", chairs.mean) : std::string(" – |");
  const GraphSummary& graph = session.map->graph;
  return row + format(" %zu / %zu | %zu | %zu | %zu | %.3f | %.3f | %zu (−%zu) | %zu / %zu |\n", report.total.found,
                      report.total.truth, e.spurious.size(), e.duplicates.size(), e.association.wrong.size(),
                      e.rmse_open_loop_m, e.rmse_optimised_m, graph.loop_closures, graph.loop_closures_revoked,
                      e.topology.rooms_found, e.topology.rooms);
}

std::size_t better_sessions(const std::vector<Session>& sessions) {
  return static_cast<std::size_t>(std::count_if(sessions.begin(), sessions.end(), [](const Session& session) {
    return session.evaluation.rmse_optimised_m < session.evaluation.rmse_open_loop_m;
  }));
}

/// All sessions of the columns and of the run with few closures.
std::vector<const Session*> all_sessions(const Study& study) {
  std::vector<const Session*> all;
  for (const Column& column : study.columns)
    for (const Session& session : column.sessions) all.push_back(&session);
  for (const Session& session : study.sparse) all.push_back(&session);
  return all;
}

const char* const kComparisonHead =
    "| | tables % | big % | small % | walls % | RMSE m | found % | false | double | wrong visits | what that means |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string comparison_row(const std::string& name, const std::vector<Session>& sessions, const char* meaning) {
  const eval::Report report = report_of(sessions);
  std::string text = "| " + name + " |";
  for (const PaperRow& paper : kPaper) text += cell(mean_percent(edge_errors(report, paper.klass)));
  std::size_t spurious = 0;
  for (const Session& session : sessions) spurious += session.evaluation.spurious.size();
  return text + format(" %.3f | %.1f | %zu | %zu | %zu | %s |\n", report.rmse_optimised_m.mean,
                       100.0 * eval::recall(report.total), spurious, report.total.duplicates, report.association.wrong,
                       meaning);
}

}  // namespace

std::string coverage_text(const Study& study) {
  const std::vector<Session>& sessions = study.columns.front().sessions;
  std::array<std::size_t, 4> rooms{};
  std::size_t corners = 0, distractors = 0, visits = 0;
  double minutes = 0.0;
  for (const Session& session : sessions) {
    ++rooms[std::min<std::size_t>(session.truth->rooms.size(), 3)];
    const auto& all = session.truth->rooms;
    corners += std::any_of(all.begin(), all.end(), [](const auto& room) { return room.size() > 4; }) ? 1 : 0;
    distractors += session.truth->distractors;
    visits += session.truth->visits.size();
    minutes += session.duration_s / 60.0;
  }
  return format(
      "Each column has the same %zu seeds. In the %s column: %zu sessions in one room, %zu in two, %zu in three, %zu "
      "of "
      "them with an L-shaped room; %.0f minutes, %zu visits to objects, %zu gestures and postures that mean nothing. "
      "Stature (1.55–1.95 m), hand, habits and furniture are drawn from the seed; the sloppiness of the touch goes "
      "from "
      "0.2 to 0.8.\n",
      sessions.size(), study.columns.front().drift.c_str(), rooms[1], rooms[2], rooms[3], corners, minutes, visits,
      distractors);
}

std::string paper_table(const std::vector<Column>& columns) {
  std::string head = "| | paper, Table I |", rule = "|---|---|";
  std::vector<eval::Report> reports;
  for (const Column& column : columns) {
    head += format(" %s drift | median |", column.drift.c_str());
    rule += "---|---|";
    reports.push_back(report_of(column.sessions));
  }
  std::string text = head + '\n' + rule + '\n';
  for (const PaperRow& row : kPaper) {
    text += format("| %s | %.1f ± %.1f (n %zu) |", eval::to_string(row.klass), row.mean, row.std, row.n);
    for (const eval::Report& report : reports) {
      const eval::Spread& spread = edge_errors(report, row.klass);
      text += format(" %s (n %zu) |", percent(spread).c_str(), spread.n);
      text += spread.n ? format(" %.1f |", spread.median) : std::string(" – |");
    }
    text += '\n';
  }
  return text;
}

std::string better_text(const std::vector<Column>& columns) {
  std::string text = "Here";
  for (std::size_t c = 0; c < columns.size(); ++c)
    text += format("%s %zu of %zu (%s)", c ? "," : "", better_sessions(columns[c].sessions), columns[c].sessions.size(),
                   columns[c].drift.c_str());
  return text + ".";
}

std::string session_table(const std::vector<Session>& sessions) {
  std::string text =
      "| seed | sloppiness | tables % | big % | small % | walls % | chairs m | found | false | double | wrong visits | "
      "open loop m | optimised m | closures | rooms |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Session& session : sessions) text += session_row(session);
  return text;
}

std::string scale_table(const std::vector<Column>& columns) {
  std::string text =
      "| drift | scale error of the trajectory % | walls % (median) | those with both neighbours touched | the same "
      "without "
      "the scale |\n|---|---|---|---|---|\n";
  const auto cell_of = [](const std::vector<double>& errors) {
    const eval::Spread spread = eval::spread_of(errors);
    return spread.n ? format(" %.1f (%.1f), n %zu |", spread.mean, spread.median, spread.n) : std::string(" – |");
  };
  for (const Column& column : columns) {
    std::vector<double> scales, all, known, without;
    for (const Session& session : column.sessions) {
      const double scale = session.evaluation.scale;
      scales.push_back(100.0 * std::abs(scale - 1.0));
      std::map<std::uint32_t, double> true_length;
      for (const eval::TruthObject& object : session.truth->objects) true_length[object.id] = object.size[0];
      for (const eval::Match& match : session.evaluation.matches) {
        if (match.klass != eval::Class::Wall) continue;
        all.push_back(match.mape_percent());
        if (eval::unknown_ends(*session.truth, match.truth_id) > 0) continue;
        known.push_back(match.mape_percent());
        const double length = true_length[match.truth_id];
        without.push_back(100.0 * std::abs(scale * match.edges_m.front() - length) / length);
      }
    }
    text += format("| %s | %.1f |", column.drift.c_str(), eval::spread_of(scales).mean) + cell_of(all) +
            cell_of(known) + cell_of(without) + '\n';
  }
  return text;
}

std::string ideal_table(const std::vector<Column>& columns) {
  std::string text =
      "| drift | class | edge error here % | the ideal estimator's % | … with the true way % "
      "|\n|---|---|---|---|---|\n";
  for (const Column& column : columns) {
    for (const eval::Class klass : {eval::Class::Table, eval::Class::BigScreen, eval::Class::SmallScreen}) {
      std::vector<double> here, suit_way, true_way;
      for (std::size_t k = 0; k < column.ideal.size(); ++k) {
        for (const eval::Match& match : column.sessions[k].evaluation.matches) {
          const auto& ideal = column.ideal[k];
          const auto same = std::ranges::find(ideal, match.truth_id, &IdealSize::truth_id);
          if (match.klass != klass || same == ideal.end()) continue;
          here.push_back(match.mape_percent());
          suit_way.push_back(same->suit_way_percent);
          true_way.push_back(same->true_way_percent);
        }
      }
      if (here.empty()) continue;
      text +=
          format("| %s | %s, n %zu | %.1f | %.1f | %.1f |\n", column.drift.c_str(), eval::to_string(klass), here.size(),
                 eval::spread_of(here).mean, eval::spread_of(suit_way).mean, eval::spread_of(true_way).mean);
    }
  }
  return text;
}

std::string ablation_table(const Column& full, const std::vector<LeverRuns>& ablation) {
  std::string text = kComparisonHead + comparison_row("**everything on**", full.sessions, "");
  for (const LeverRuns& runs : ablation) text += comparison_row(runs.lever.name, runs.sessions, runs.lever.meaning);
  return text;
}

std::string slipping_table(const std::vector<SlippingFeet>& slipping) {
  std::string text = kComparisonHead;
  for (const SlippingFeet& runs : slipping) {
    text += comparison_row("**" + runs.drift + "**", runs.heard, "");
    text += comparison_row(runs.drift + ", " + feet_not_heard().name, runs.not_heard, feet_not_heard().meaning);
  }
  return text;
}

std::string sparse_text(const std::vector<Session>& sessions) {
  const eval::Report report = report_of(sessions);
  std::size_t rooms = 0, found = 0;
  for (const Session& session : sessions) {
    rooms += session.evaluation.topology.rooms;
    found += session.evaluation.topology.rooms_found;
  }
  std::string text = format(
      "The same seeds, but the wearer touches something known only every so often. A map is right but for its measures "
      "when every object touched is there once, made of its own visits only, and every room whose walls were all "
      "touched "
      "has these walls in this order. That holds in **%zu of %zu** sessions; %zu of %zu rooms are right; of %zu visits "
      "%zu "
      "hang on the wrong object, %zu objects are double. Objects found where they are (within 1.2 m): %.1f %%; "
      "trajectory "
      "RMSE %.2f → %.2f m.\n\n",
      report.topology_right, sessions.size(), found, rooms, report.association.visits, report.association.wrong,
      report.association.split, 100.0 * eval::recall(report.total), report.rmse_open_loop_m.mean,
      report.rmse_optimised_m.mean);
  for (const Session& session : sessions) {
    const auto& wrong = session.evaluation.topology.wrong;
    if (wrong.empty()) continue;
    text += format("- seed %llu: ", static_cast<unsigned long long>(session.sim.seed));
    for (std::size_t i = 0; i < wrong.size(); ++i) text += (i ? "; " : "") + wrong[i];
    text += "\n";
  }
  return text;
}

std::string nothing_text(const Study& study) {
  std::size_t distractors = 0, phantom = 0, stray = 0;
  const auto sessions = all_sessions(study);
  for (const Session* session : sessions) {
    distractors += session->truth->distractors;
    phantom += session->evaluation.association.phantom.size();
    for (const eval::WrongVisit& visit : session->evaluation.association.wrong) stray += visit.visited_id ? 0 : 1;
  }
  std::string text = format(
      "In %zu sessions %zu gestures and postures mean nothing (phone at the ear, crossed arms, squat, kneel, stoop, a "
      "lean "
      "against the wall …). **%zu** objects came of them, and %zu visits to objects that are there.\n",
      sessions.size(), distractors, phantom, stray);
  if (study.quiet.empty()) return text;
  text += "\nReal people, who draw nothing and do not sit:\n\n| recording | s | objects |\n|---|---|---|\n";
  for (const QuietRecording& recording : study.quiet)
    text += format("| %s | %.0f | %zu |\n", recording.name.c_str(), recording.duration_s, recording.objects);
  return text;
}

}  // namespace kinemap::bench
