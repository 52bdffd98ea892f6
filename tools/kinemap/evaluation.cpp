// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/assignment.hpp"
#include "tools/kinemap/alignment.hpp"
#include "tools/kinemap/shape.hpp"

namespace kinemap::eval {
namespace {

std::size_t index(Class c) { return static_cast<std::size_t>(c); }

/// Fills in the alignment and both trajectory errors.
std::optional<Error> compare_trajectory(const MapSnapshot& map, const Truth& truth, Evaluation& result) {
  std::vector<Eigen::Vector3d> optimised, odometry, real;
  for (const TrajectoryPose& pose : map.trajectory) {
    const auto T_truth_pelvis = pose_at(truth.trajectory, pose.time_s);
    if (!T_truth_pelvis) continue;
    if (real.empty()) result.T_truth_start = align_at(pose.T_map_pelvis, *T_truth_pelvis);
    optimised.push_back(pose.T_map_pelvis.p);
    odometry.push_back(pose.T_odom_pelvis.p);
    real.push_back(T_truth_pelvis->p);
  }
  const auto T_truth_map = align(optimised, real), T_truth_odom = align(odometry, real);
  if (!T_truth_map || !T_truth_odom)
    return Error{"the trajectories cannot be aligned: " + std::to_string(real.size()) + " of " +
                 std::to_string(map.trajectory.size()) + " poses lie within the truth's time; is it the same session?"};
  result.poses = real.size();
  result.T_truth_map = *T_truth_map;
  result.scale = scale_between(optimised, real).value_or(1.0);
  result.rmse_optimised_m = rmse(*T_truth_map, optimised, real);
  result.rmse_open_loop_m = rmse(*T_truth_odom, odometry, real);
  return std::nullopt;
}

Match match_of(const TruthObject& truth, const MapObject& object, const Shape& real, const Shape& estimate) {
  Match match{truth.id, object.id, truth.klass, {}, {}, 0.0, 0.0, 0.0, {}};
  for (std::size_t i = 0; i < edge_count(truth.type); ++i) {
    match.edges_m.push_back(estimate.size[i]);
    match.edge_errors_percent.push_back(100.0 * std::abs(estimate.size[i] - real.size[i]) / real.size[i]);
  }
  match.level_error_m = level_error(real, estimate);
  match.height_error_m = estimate.centre.z() - real.centre.z();
  match.heading_error_rad = heading_error(real, estimate);
  return match;
}

/// What an object of the map without a match counts as, and whether it is the second one for something real.
void count_unmatched(const MapObject& object, const Shape& estimate, const Truth& truth, const std::vector<Shape>& real,
                     Evaluation& result) {
  const auto stands_for = std::find_if(
      real.begin(), real.end(), [&](const Shape& shape) { return std::isfinite(matching_cost(shape, estimate)); });
  if (stands_for == real.end()) {
    ++result.counts[index(class_of(object.type, estimate.size[0]))].estimated;
    result.spurious.push_back(object.id);
    return;
  }
  ClassCounts& counts = result.counts[index(truth.objects[static_cast<std::size_t>(stands_for - real.begin())].klass)];
  ++counts.estimated;
  ++counts.duplicates;
  result.duplicates.push_back(object.id);
}

void compare_objects(const MapSnapshot& map, const Truth& truth, Evaluation& result) {
  std::vector<Shape> real, estimates;
  for (const TruthObject& object : truth.objects) real.push_back(shape_of(object));
  for (const MapObject& object : map.objects) estimates.push_back(shape_of(object, result.T_truth_map));

  Eigen::MatrixXd cost(real.size(), estimates.size());
  for (std::size_t r = 0; r < real.size(); ++r)
    for (std::size_t e = 0; e < estimates.size(); ++e)
      cost(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e)) = matching_cost(real[r], estimates[e]);

  std::vector<char> taken(estimates.size(), 0);
  const auto assignment = assign(cost);
  for (std::size_t r = 0; r < real.size(); ++r) {
    ClassCounts& counts = result.counts[index(truth.objects[r].klass)];
    ++counts.truth;
    if (!assignment[r]) {
      result.missed.push_back(truth.objects[r].id);
      continue;
    }
    const std::size_t e = *assignment[r];
    taken[e] = 1;
    ++counts.found;
    ++counts.estimated;
    result.matches.push_back(match_of(truth.objects[r], map.objects[e], real[r], estimates[e]));
    result.matches.back().normalised =
        normalised_errors(real[r], map.objects[e], {.from_start = result.T_truth_start, .aligned = result.T_truth_map});
  }
  for (std::size_t e = 0; e < estimates.size(); ++e)
    if (!taken[e]) count_unmatched(map.objects[e], estimates[e], truth, real, result);
}

}  // namespace

double Match::mape_percent() const {
  if (edge_errors_percent.empty()) return 0.0;
  return std::accumulate(edge_errors_percent.begin(), edge_errors_percent.end(), 0.0) /
         static_cast<double>(edge_errors_percent.size());
}

Result<Evaluation> evaluate(const MapSnapshot& map, const Truth& truth) {
  Evaluation result;
  if (auto error = compare_trajectory(map, truth, result)) return *error;
  compare_objects(map, truth, result);
  std::map<std::uint32_t, std::uint32_t> truth_of;
  for (const Match& match : result.matches) truth_of[match.object_id] = match.truth_id;
  result.association = check_association(map.objects, truth.visits, truth_of);
  result.topology = check_topology(map, truth, result.association);
  return result;
}

}  // namespace kinemap::eval
