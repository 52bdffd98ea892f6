// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/occupancy.hpp"

#include <algorithm>
#include <cmath>

#include "core/mapper/polygon.hpp"
#include "protocol/export/walls.hpp"
#include "protocol/floor.hpp"
#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

using Cell = OccupancyGrid::Cell;

constexpr double kCell = 0.05;        // m, what ROS maps usually have
constexpr double kBodyRadius = 0.25;  // m: half of a body's width at the shoulders
constexpr double kSeatHalfSide = 0.21;
constexpr double kMargin = 0.5;  // m of unknown cells all round
constexpr double kMostCells = 4e6;

using Outline = std::vector<Eigen::Vector2d>;

std::vector<Outline> obstacles(const MapSnapshot& map, const std::vector<WallStretch>& walls) {
  std::vector<Outline> outlines;
  for (const WallStretch& wall : walls) {
    const auto corners = wall.outline(kWallThickness);
    if (!wall.open && wall.wall_id != 0) outlines.emplace_back(corners.begin(), corners.end());
  }
  for (const MapObject& object : map.objects) {
    if (object.type == ObjectType::Table && object.corners) {
      Outline& outline = outlines.emplace_back();
      for (const Eigen::Vector3d& corner : *object.corners) outline.emplace_back(corner.head<2>());
    }
    if (object.type == ObjectType::Chair) {
      Outline& outline = outlines.emplace_back();
      for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
        outline.emplace_back((object.pose * (kSeatHalfSide * Eigen::Vector3d(x, y, 0))).head<2>());
    }
  }
  return outlines;
}

std::vector<Outline> doorways(const std::vector<WallStretch>& walls) {
  std::vector<Outline> outlines;
  for (const WallStretch& wall : walls) {
    const auto corners = wall.outline(kWallThickness);
    if (wall.open) outlines.emplace_back(corners.begin(), corners.end());
  }
  return outlines;
}

/// A grid over the walked floor and all obstacles, without its cells.
OccupancyGrid frame_of(const CellGrid& walked, const std::vector<Outline>& solid) {
  std::vector<Eigen::Vector2d> points;
  for (const Outline& outline : solid) points.insert(points.end(), outline.begin(), outline.end());
  if (!walked.cells.empty()) {
    const Eigen::Vector2d size(static_cast<double>(walked.columns), static_cast<double>(walked.rows));
    points.insert(points.end(), {walked.origin, walked.origin + walked.cell_m * size});
  }
  Eigen::Array2d low = Eigen::Array2d::Zero(), high = low;
  if (!points.empty()) low = high = points.front();
  for (const Eigen::Vector2d& p : points) {
    low = low.min(p.array());
    high = high.max(p.array());
  }
  // On multiples of the resolution, so that the same place stays in the same cell as the map grows.
  const Eigen::Array2d first = ((low - kMargin) / walked.cell_m).round();
  const Eigen::Array2d size = ((high + kMargin) / walked.cell_m).ceil() - first;
  OccupancyGrid grid;
  grid.resolution_m = walked.cell_m;
  grid.origin = first * walked.cell_m;
  grid.columns = static_cast<std::size_t>(size.x());
  grid.rows = static_cast<std::size_t>(size.y());
  return grid;
}

void fill(OccupancyGrid& grid, const Outline& outline, Cell value) {
  Eigen::Array2d low = outline.front(), high = low;
  for (const Eigen::Vector2d& p : outline) {
    low = low.min(p.array());
    high = high.max(p.array());
  }
  const auto index = [&](double p, double origin) {
    return static_cast<std::size_t>(std::max(0.0, std::floor((p - origin) / grid.resolution_m)));
  };
  const std::size_t last_row = std::min(grid.rows - 1, index(high.y(), grid.origin.y()));
  const std::size_t last_column = std::min(grid.columns - 1, index(high.x(), grid.origin.x()));
  for (std::size_t row = index(low.y(), grid.origin.y()); row <= last_row; ++row)
    for (std::size_t column = index(low.x(), grid.origin.x()); column <= last_column; ++column) {
      const Eigen::Vector2d cell(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      if (contains(outline, grid.origin + grid.resolution_m * cell)) grid.cells[row * grid.columns + column] = value;
    }
}

/// The walked floor, and an unpainted grid with the same cells round it: the smallest cells that are not too many.
std::pair<CellGrid, OccupancyGrid> grids(const MapSnapshot& map, const std::vector<WallStretch>& walls,
                                         const std::vector<Outline>& solid) {
  for (double cell = kCell;;) {
    CellGrid walked = walked_floor(map.trajectory, cell, kBodyRadius, walls);
    if (walked.cells.empty()) walked.cell_m = cell;
    OccupancyGrid grid = frame_of(walked, solid);
    if (static_cast<double>(grid.columns) * static_cast<double>(grid.rows) <= kMostCells) return {walked, grid};
    cell = 2 * walked.cell_m;
  }
}

}  // namespace

OccupancyGrid occupancy_grid(const MapSnapshot& map) {
  const std::vector<WallStretch> walls = wall_stretches(map);
  const std::vector<Outline> solid = obstacles(map, walls);
  auto [walked, grid] = grids(map, walls, solid);
  grid.cells.assign(grid.columns * grid.rows, Cell::Unknown);
  const Eigen::Array2d shift = ((walked.origin - grid.origin) / grid.resolution_m).array().round().max(0.0);
  const auto left = static_cast<std::size_t>(shift.x()), below = static_cast<std::size_t>(shift.y());
  for (std::size_t row = 0; row < walked.rows; ++row)
    for (std::size_t column = 0; column < walked.columns; ++column)
      if (walked.at(column, row)) grid.cells[(below + row) * grid.columns + left + column] = Cell::Free;
  for (const Outline& outline : solid) fill(grid, outline, Cell::Occupied);
  for (const Outline& outline : doorways(walls)) fill(grid, outline, Cell::Free);
  return grid;
}

std::string floor_pgm(const MapSnapshot& map) {
  const OccupancyGrid grid = occupancy_grid(map);
  std::string picture = format("P5\n# Kinemap, map revision %llu\n%zu %zu\n255\n",
                               static_cast<unsigned long long>(map.revision), grid.columns, grid.rows);
  picture.reserve(picture.size() + grid.cells.size());
  constexpr char kGrey[] = {'\xCD', '\xFE', '\0'};  // unknown, free, occupied
  for (std::size_t row = grid.rows; row-- > 0;)
    for (std::size_t column = 0; column < grid.columns; ++column)
      picture += kGrey[static_cast<std::size_t>(grid.at(column, row))];
  return picture;
}

std::string floor_yaml(const MapSnapshot& map) {
  const OccupancyGrid grid = occupancy_grid(map);
  return format(
      "# Kinemap, map revision %llu, map frame\n"
      "image: floor.pgm\nmode: trinary\nresolution: %.2f\norigin: [%.2f, %.2f, 0.0]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
      static_cast<unsigned long long>(map.revision), grid.resolution_m, grid.origin.x(), grid.origin.y());
}

}  // namespace kinemap
