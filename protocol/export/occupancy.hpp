// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/map.hpp"

namespace kinemap {

/// Where one can walk, seen from above, all levels in one. Cell (column, row) covers the square from
/// `origin + resolution · (column, row)`; its sides run along the axes of the map frame.
struct OccupancyGrid {
  enum class Cell : std::uint8_t { Unknown, Free, Occupied };

  double resolution_m = 0.05;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< corner of the first cell, map frame, m
  std::size_t columns = 0, rows = 0;
  std::vector<Cell> cells;  ///< by rows, the first one at the lowest y

  [[nodiscard]] Cell at(std::size_t column, std::size_t row) const { return cells[row * columns + column]; }
};

/// Free: where the wearer's body went, half its width on either side of the trajectory. Occupied: walls, tables and
/// seats, but for the doorways, which are free. All else, inferred walls too, is unknown. Cells of 5 cm; twice as wide
/// as often as a large map needs it (at most 4 million). A map without anything is 1 m² of unknown cells.
OccupancyGrid occupancy_grid(const MapSnapshot& map);

/// The grid as ROS's map_server and Nav2 read it: a picture (254 free, 0 occupied, 205 unknown; the top row is the
/// highest y) and what says where it lies. The YAML names the picture "floor.pgm".
std::string floor_pgm(const MapSnapshot& map);
std::string floor_yaml(const MapSnapshot& map);

}  // namespace kinemap
