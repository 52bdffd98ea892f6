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

}  // namespace kinemap::graph
