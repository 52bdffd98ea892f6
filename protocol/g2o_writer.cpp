// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "protocol/g2o.hpp"

namespace kinemap {
namespace {

using graph::Matrix6;

/// e_tangent = S·e_quaternion to first order, because the vector part is half the angle.
Matrix6 tangent_scale() {
  Matrix6 s = Matrix6::Identity();
  s.diagonal().tail<3>().setConstant(2.0);
  return s;
}

/// Shortest decimal that reads back to the same double.
void append(std::string& text, double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  text += ' ';
  text.append(buffer, result.ptr);
}

void append(std::string& text, const Pose& T) {
  for (const double v : {T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()}) append(text, v);
}

void append(std::string& text, const graph::BetweenFactor& f) {
  append(text, f.T_i_j);
  const Matrix6 U = f.sqrt_information * tangent_scale();
  const Matrix6 information = U.transpose() * U;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) append(text, information(r, c));
  }
}

void append(std::string& text, const MapObject& object) {
  text += "# object " + std::to_string(object.id) + ' ' + to_string(object.type);
  append(text, object.pose);
  if (object.size)
    for (const double side : *object.size) append(text, side);
  text += '\n';
}

graph::BetweenFactor step_factor(const TrajectoryPose& from, const TrajectoryPose& to, std::size_t index) {
  graph::BetweenFactor f;
  f.i = index - 1;
  f.j = index;
  f.T_i_j = from.T_odom_pelvis.inverse() * to.T_odom_pelvis;
  const StepSigma& s = to.step;
  f.sqrt_information.diagonal() << s.level_m, s.level_m, s.up_m, s.tilt_rad, s.tilt_rad, s.heading_rad;
  f.sqrt_information.diagonal() = f.sqrt_information.diagonal().cwiseInverse().eval();
  return f;
}

}  // namespace

std::string g2o_text(const graph::Graph& graph, std::span<const std::int64_t> ids) {
  const auto id = [&](std::size_t i) { return std::to_string(i < ids.size() ? ids[i] : static_cast<std::int64_t>(i)); };
  std::string text = "# kinemap: pose graph, map frame, z up, metres\n";
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    text += "VERTEX_SE3:QUAT " + id(i);
    append(text, graph.poses[i]);
    text += '\n';
  }
  for (const graph::PriorFactor& f : graph.priors) text += "FIX " + id(f.i) + '\n';
  for (const graph::BetweenFactor& f : graph.between) {
    text += "EDGE_SE3:QUAT " + id(f.i) + ' ' + id(f.j);
    append(text, f);
    text += '\n';
  }
  return text;
}

std::string g2o_text(const MapSnapshot& map) {
  graph::Graph graph;
  for (std::size_t k = 0; k < map.trajectory.size(); ++k) {
    graph.poses.push_back(map.trajectory[k].T_map_pelvis);
    if (k > 0) graph.between.push_back(step_factor(map.trajectory[k - 1], map.trajectory[k], k));
  }
  if (!graph.poses.empty()) graph.priors.push_back({0, graph.poses.front(), Matrix6::Identity()});
  std::string text = g2o_text(graph);
  for (const MapObject& object : map.objects) append(text, object);
  return text;
}

double g2o_cost(const graph::Graph& graph) {
  double sum = 0.0;
  for (const graph::BetweenFactor& f : graph.between) {
    const Pose d = f.T_i_j.inverse() * (graph.poses[f.i].inverse() * graph.poses[f.j]);
    Eigen::Matrix<double, 6, 1> e;
    e << d.p, (d.q.w() < 0.0 ? -1.0 : 1.0) * d.q.vec();
    sum += (f.sqrt_information * tangent_scale() * e).squaredNorm();
  }
  return sum;
}

}  // namespace kinemap
