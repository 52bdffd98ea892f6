// SPDX-License-Identifier: Apache-2.0
#include "core/graph/graph.hpp"

#include "core/graph/factors.hpp"

namespace kinemap::graph {

Pose landmark_pose(const Landmark& landmark) {
  const Surface surface(landmark.kind, landmark.x.data(), landmark.anchor);
  Eigen::Matrix3d R;
  R << surface.u(), surface.v(), surface.w();
  return {surface.origin(), Eigen::Quaterniond(R).normalized()};
}

Eigen::Vector3d contact_error(const Landmark& landmark, const Eigen::Vector3d& p_map, Edge edge, Edge corner) {
  const Surface surface(landmark.kind, landmark.x.data(), landmark.anchor);
  Eigen::Vector3d e(surface.plane(p_map).value, 0.0, 0.0);
  if (surface.is_rectangle() && edge != Edge::None) e(1) = surface.side(p_map, edge).value;
  if (surface.is_rectangle() && corner != Edge::None) e(2) = surface.side(p_map, corner).value;
  return e;
}

double weighted_square(const Graph& graph, const ContactFactor& c) {
  const Eigen::Vector3d p_map = graph.poses[c.i] * (c.T_i_hand * graph.touch_points[c.touch].p_hand);
  const Eigen::Vector3d sigma(c.sigma_plane_m, c.sigma_edge_m, c.sigma_corner_m);
  const double s =
      contact_error(graph.landmarks[c.landmark], p_map, c.edge, c.corner).cwiseQuotient(sigma).squaredNorm();
  const double scale2 = c.loss.scale * c.loss.scale;
  return c.loss.kind == Loss::Kind::Cauchy ? s / (1.0 + s / scale2) : s;
}

}  // namespace kinemap::graph
