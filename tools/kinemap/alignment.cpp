// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/alignment.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap::eval {
namespace {

Eigen::Vector3d mean(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<Pose> align(std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth) {
  if (p_map.size() != p_truth.size() || p_map.size() < 2) return std::nullopt;
  const Eigen::Vector3d centre_map = mean(p_map), centre_truth = mean(p_truth);
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const Eigen::Vector3d a = p_map[i] - centre_map, b = p_truth[i] - centre_truth;
    dot += a.x() * b.x() + a.y() * b.y();
    cross += a.x() * b.y() - a.y() * b.x();
  }
  if (std::hypot(dot, cross) < 1e-12) return std::nullopt;
  Pose T_truth_map = level_pose(Eigen::Vector3d::Zero(), std::atan2(cross, dot));
  T_truth_map.p = centre_truth - T_truth_map.q * centre_map;
  return T_truth_map;
}

double rmse(const Pose& T_truth_map, std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p_map.size(); ++i) sum += (T_truth_map * p_map[i] - p_truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(p_map.size()));
}

std::optional<double> scale_between(std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth) {
  const auto extent = [](std::span<const Eigen::Vector3d> points) {
    const Eigen::Vector3d centre = mean(points);
    double sum = 0.0;
    for (const Eigen::Vector3d& p : points) sum += (p - centre).head<2>().squaredNorm();
    return sum;
  };
  if (p_map.size() != p_truth.size() || p_map.empty()) return std::nullopt;
  const double map = extent(p_map), truth = extent(p_truth);
  if (map < 1e-12 || truth < 1e-12) return std::nullopt;
  return std::sqrt(truth / map);
}

Pose align_at(const Pose& T_map_pelvis, const Pose& T_truth_pelvis) {
  const double turn = heading_of(T_truth_pelvis.q) - heading_of(T_map_pelvis.q);
  Pose T_truth_map = level_pose(Eigen::Vector3d::Zero(), turn);
  T_truth_map.p = T_truth_pelvis.p - T_truth_map.q * T_map_pelvis.p;
  return T_truth_map;
}

std::optional<Pose> pose_at(std::span<const TimedPose> trajectory, double time_s) {
  constexpr double kSlack = 1e-4;  // times in files are rounded to a millisecond or a microsecond
  if (trajectory.empty() || time_s < trajectory.front().time_s - kSlack || time_s > trajectory.back().time_s + kSlack)
    return std::nullopt;
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_s,
                                      [](const TimedPose& pose, double t) { return pose.time_s < t; });
  if (after == trajectory.begin()) return trajectory.front().pose;
  if (after == trajectory.end()) return trajectory.back().pose;
  const TimedPose& a = *std::prev(after);
  const double part = (time_s - a.time_s) / (after->time_s - a.time_s);
  return Pose{a.pose.p + part * (after->pose.p - a.pose.p), a.pose.q.slerp(part, after->pose.q)};
}

}  // namespace kinemap::eval
