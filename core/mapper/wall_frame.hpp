// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/graph/graph.hpp"

namespace kinemap {

/// A wall's plane as a frame: origin at the foot of its anchor, `axis` level along it with the room on the left,
/// `normal` into the room. Going along `axis` from wall to wall goes counter-clockwise round a room.
struct WallFrame {
  explicit WallFrame(const graph::Landmark& wall)
      : normal(std::cos(wall.x[0]), std::sin(wall.x[0]), 0.0),
        axis(normal.y(), -normal.x(), 0.0),
        origin(wall.anchor + wall.x[1] * normal) {}

  [[nodiscard]] double distance(const Eigen::Vector3d& p) const { return normal.dot(p - origin); }
  [[nodiscard]] double along(const Eigen::Vector3d& p) const { return axis.dot(p - origin); }
  [[nodiscard]] Eigen::Vector3d point(double s) const { return origin + s * axis; }

  Eigen::Vector3d normal, axis, origin;
};

}  // namespace kinemap
