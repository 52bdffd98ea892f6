// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/worst_cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "tools/kinemap/alignment.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <class List, class Id>
const typename List::value_type* by_id(const List& list, Id id) {
  const auto found = std::find_if(list.begin(), list.end(), [id](const auto& item) { return item.id == id; });
  return found == list.end() ? nullptr : &*found;
}

/// Level error of the suit's own and of the optimised trajectory during some time, each after its alignment, m.
struct Drift {
  double open_loop_m = 0.0, optimised_m = 0.0, heading_rad = 0.0;
};
Drift drift_during(const Session& session, double begin_s, double end_s) {
  std::vector<Eigen::Vector3d> odometry, optimised, real;
  std::vector<char> inside;
  double turned = 0.0;
  std::size_t n = 0;
  for (const TrajectoryPose& pose : session.map->trajectory) {
    const auto T_truth_pelvis = eval::pose_at(session.truth->trajectory, pose.time_s);
    if (!T_truth_pelvis) continue;
    odometry.push_back(pose.T_odom_pelvis.p);
    optimised.push_back(session.evaluation.T_truth_map * pose.T_map_pelvis.p);
    real.push_back(T_truth_pelvis->p);
    inside.push_back(pose.time_s >= begin_s && pose.time_s <= end_s);
    if (!inside.back()) continue;
    ++n;
    turned += std::remainder(
        heading_of((session.evaluation.T_truth_map * pose.T_map_pelvis).q) - heading_of(T_truth_pelvis->q),
        2 * std::numbers::pi);
  }
  const auto T_truth_odom = eval::align(odometry, real);
  Drift drift;
  if (!T_truth_odom || n == 0) return drift;
  for (std::size_t i = 0; i < real.size(); ++i) {
    if (!inside[i]) continue;
    drift.open_loop_m += (*T_truth_odom * odometry[i] - real[i]).head<2>().norm() / static_cast<double>(n);
    drift.optimised_m += (optimised[i] - real[i]).head<2>().norm() / static_cast<double>(n);
  }
  drift.heading_rad = turned / static_cast<double>(n);
  return drift;
}

std::string sizes(const eval::TruthObject& truth, const eval::Match& match, const MapObject& object) {
  std::string text;
  for (std::size_t i = 0; i < match.edges_m.size(); ++i) {
    if (i) text += " and ";
    text += format("%.2f m came out as %.2f m", truth.size[i], match.edges_m[i]);
    if (object.sigma.size_m[i] > 0.0) text += format(" (the map says ± %.2f m)", object.sigma.size_m[i]);
  }
  return text;
}

/// How far each end of a wall lies from the true one along it; positive: too long there.
std::string wall_ends(const eval::TruthObject& truth, const MapObject& object, const Session& session) {
  const std::size_t unknown = eval::unknown_ends(*session.truth, truth.id);
  const Pose pose = session.evaluation.T_truth_map * object.pose;
  const Eigen::Vector2d axis = (truth.pose.q * Eigen::Vector3d::UnitY()).head<2>();
  const double shift = axis.dot((pose.p - truth.pose.p).head<2>()), longer = ((*object.size)[0] - truth.size[0]) / 2;
  return format(" One end is %+.2f m off along the wall, the other %+.2f m (+: too far out).", longer + shift,
                longer - shift) +
         (unknown == 0   ? ""
          : unknown == 1 ? " One of its neighbours was never touched, so its end there can only be inferred."
                         : " Neither of its neighbours was ever touched, so its ends can only be inferred.");
}

std::string visits(const WorstCase& worst, const MapObject& object) {
  const eval::Truth& truth = *worst.session->truth;
  const auto real = static_cast<std::size_t>(
      std::count_if(truth.visits.begin(), truth.visits.end(),
                    [&](const eval::TruthVisit& visit) { return visit.object == worst.match->truth_id; }));
  std::string text = format(" It was touched %zu time%s and the map has %zu visit%s of it", real, real == 1 ? "" : "s",
                            object.visits.size(), object.visits.size() == 1 ? "" : "s");
  std::size_t wrong = 0;
  for (const eval::WrongVisit& visit : worst.session->evaluation.association.wrong)
    wrong += visit.object_id == object.id;
  text += wrong ? format(", %zu of them to something else.", wrong) : std::string(".");
  for (const UnresolvedTrace& trace : worst.session->map->unresolved)
    for (const eval::TruthVisit& visit : truth.visits)
      if (visit.object == worst.match->truth_id && trace.begin_s < visit.end_s && visit.begin_s < trace.end_s)
        text += format(" The trace at %.0f s was not understood (%s).", visit.begin_s, trace.reason.c_str());
  return text;
}

std::string drift(const WorstCase& worst, const MapObject& object) {
  if (object.visits.empty()) return "";
  const Visit& first = object.visits.front();
  const Drift then = drift_during(*worst.session, first.begin_s, first.end_s);
  return format(
      " During the first visit, at %.0f s of %.0f s, the suit was %.2f m off, the optimised trajectory %.2f m and "
      "%.1f°.",
      first.begin_s, worst.session->duration_s, then.open_loop_m, then.optimised_m,
      kDegrees * std::abs(then.heading_rad));
}

std::string circumstances(const WorstCase& worst) {
  const eval::Evaluation& evaluation = worst.session->evaluation;
  const GraphSummary& graph = worst.session->map->graph;
  return format(
      " In this session %zu loops were closed (%zu taken back), %zu visits hang on wrong objects, the trajectory went "
      "from %.2f to %.2f m RMSE; the wearer touched with sloppiness %.2f.",
      graph.loop_closures, graph.loop_closures_revoked, evaluation.association.wrong.size(),
      evaluation.rmse_open_loop_m, evaluation.rmse_optimised_m, worst.session->sim.sloppiness);
}

}  // namespace

std::vector<WorstCase> worst_cases(std::span<const Column> columns, std::size_t count) {
  std::vector<WorstCase> cases;
  for (const Column& column : columns)
    for (const Session& session : column.sessions) {
      const auto& matches = session.evaluation.matches;
      const auto worst = std::max_element(
          matches.begin(), matches.end(),
          [](const eval::Match& a, const eval::Match& b) { return a.mape_percent() < b.mape_percent(); });
      if (worst != matches.end()) cases.push_back({column.drift, &session, &*worst});
    }
  std::stable_sort(cases.begin(), cases.end(), [](const WorstCase& a, const WorstCase& b) {
    return a.match->mape_percent() > b.match->mape_percent();
  });
  std::set<std::uint64_t> seeds;
  std::erase_if(cases, [&](const WorstCase& one) { return !seeds.insert(one.session->sim.seed).second; });
  if (cases.size() > count) cases.resize(count);
  return cases;
}

std::string case_name(const WorstCase& worst) {
  std::string klass = eval::to_string(worst.match->klass);
  std::replace(klass.begin(), klass.end(), ' ', '-');
  return format("%s-seed%llu-%s%u", worst.drift.c_str(), static_cast<unsigned long long>(worst.session->sim.seed),
                klass.c_str(), worst.match->truth_id);
}

std::string explain(const WorstCase& worst) {
  const auto* truth = by_id(worst.session->truth->objects, worst.match->truth_id);
  const auto* object = by_id(worst.session->map->objects, worst.match->object_id);
  if (!truth || !object) return "";
  std::string text = format("A %s: ", eval::to_string(worst.match->klass)) + sizes(*truth, *worst.match, *object) + ".";
  if (truth->type == ObjectType::Wall) text += wall_ends(*truth, *object, *worst.session);
  return text + visits(worst, *object) + drift(worst, *object) + circumstances(worst);
}

}  // namespace kinemap::bench
