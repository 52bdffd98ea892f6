// SPDX-License-Identifier: Apache-2.0
#include "protocol/floor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

constexpr double kLongestStep = 2.0;  // m
constexpr double kMostCells = 1e6;
constexpr double kRounding = 1e-9;  // a way that ends where a cell ends needs no cell more

CellGrid empty_grid(std::span<const TrajectoryPose> trajectory, double cell_m, double reach_m) {
  Eigen::Array2d low = trajectory.front().T_map_pelvis.p.head<2>(), high = low;
  for (const TrajectoryPose& pose : trajectory) {
    low = low.min(pose.T_map_pelvis.p.head<2>().array());
    high = high.max(pose.T_map_pelvis.p.head<2>().array());
  }
  CellGrid grid;
  Eigen::Array2d first, size;
  for (grid.cell_m = cell_m;; grid.cell_m *= 2) {
    first = ((low - reach_m) / grid.cell_m + kRounding).floor();
    size = ((high + reach_m) / grid.cell_m - kRounding).ceil() - first;
    if (size.prod() <= kMostCells) break;
  }
  grid.origin = first * grid.cell_m;
  grid.columns = static_cast<std::size_t>(size.x());
  grid.rows = static_cast<std::size_t>(size.y());
  grid.cells.assign(grid.columns * grid.rows, 0);
  return grid;
}

/// The point of the way from a to b that is nearest to p.
Eigen::Vector2d nearest(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double length2 = (b - a).squaredNorm();
  return a + (length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0) * (b - a);
}

/// Marks the cells whose middle is within reach of the way from a to b, with no wall in between.
void mark(CellGrid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double reach_m,
          std::span<const WallStretch> walls) {
  const Eigen::Vector2d low = a.cwiseMin(b).array() - reach_m, high = a.cwiseMax(b).array() + reach_m;
  std::vector<const WallStretch*> near;
  for (const WallStretch& wall : walls)
    if (!wall.open && (wall.a.cwiseMin(wall.b) - high).maxCoeff() < 0.0 &&
        (low - wall.a.cwiseMax(wall.b)).maxCoeff() < 0.0)
      near.push_back(&wall);
  const auto index = [&](double p, double origin, std::size_t count) {
    return static_cast<std::size_t>(
        std::clamp(std::floor((p - origin) / grid.cell_m), 0.0, static_cast<double>(count - 1)));
  };
  const std::size_t last_row = index(high.y(), grid.origin.y(), grid.rows);
  const std::size_t last_column = index(high.x(), grid.origin.x(), grid.columns);
  for (std::size_t row = index(low.y(), grid.origin.y(), grid.rows); row <= last_row; ++row)
    for (std::size_t column = index(low.x(), grid.origin.x(), grid.columns); column <= last_column; ++column) {
      const Eigen::Vector2d middle = grid.origin + grid.cell_m * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                                                                 static_cast<double>(row) + 0.5);
      const Eigen::Vector2d body = nearest(middle, a, b);
      if ((middle - body).norm() > reach_m) continue;
      const auto hides = [&](const WallStretch* wall) { return ways_cross(body, middle, wall->a, wall->b); };
      if (std::none_of(near.begin(), near.end(), hides)) grid.at(column, row) = 1;
    }
}

}  // namespace

double floor_height(const MapSnapshot& map, const Room* room) {
  std::optional<double> z;
  for (const MapObject& object : map.objects) {
    if (object.type != ObjectType::Wall || !object.corners) continue;
    if (room && std::find(room->wall_ids.begin(), room->wall_ids.end(), object.id) == room->wall_ids.end()) continue;
    for (const Eigen::Vector3d& corner : *object.corners) z = std::min(z.value_or(corner.z()), corner.z());
  }
  return z.value_or(0.0);
}

std::vector<double> floor_heights(const MapSnapshot& map) {
  std::unordered_map<std::uint32_t, double> lowest;
  for (const MapObject& object : map.objects) {
    if (object.type != ObjectType::Wall || !object.corners) continue;
    double& z = lowest.emplace(object.id, object.corners->front().z()).first->second;
    for (const Eigen::Vector3d& corner : *object.corners) z = std::min(z, corner.z());
  }
  std::vector<double> heights;
  for (const Room& room : map.rooms) {
    std::optional<double> z;
    for (const std::uint32_t id : room.wall_ids)
      if (const auto wall = lowest.find(id); wall != lowest.end()) z = std::min(z.value_or(wall->second), wall->second);
    heights.push_back(z.value_or(0.0));
  }
  return heights;
}

CellGrid walked_floor(std::span<const TrajectoryPose> trajectory, double cell_m, double reach_m,
                      std::span<const WallStretch> walls) {
  if (trajectory.empty()) return {};
  CellGrid grid = empty_grid(trajectory, cell_m, reach_m);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Eigen::Vector2d to = trajectory[i].T_map_pelvis.p.head<2>();
    const Eigen::Vector2d from = i > 0 ? trajectory[i - 1].T_map_pelvis.p.head<2>().eval() : to;
    mark(grid, (to - from).norm() <= kLongestStep ? from : to, to, reach_m, walls);
  }
  return grid;
}

}  // namespace kinemap
