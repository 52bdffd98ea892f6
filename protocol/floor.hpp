// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/map.hpp"
#include "protocol/export/walls.hpp"

namespace kinemap {

/// Square cells on the floor, in the map frame.
struct CellGrid {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< outer corner of cell (0, 0), m
  double cell_m = 0.0;
  std::size_t columns = 0;          ///< along x
  std::size_t rows = 0;             ///< along y
  std::vector<std::uint8_t> cells;  ///< row by row; 1: walked, 0: not known

  [[nodiscard]] std::uint8_t& at(std::size_t column, std::size_t row) { return cells[row * columns + column]; }
  [[nodiscard]] std::uint8_t at(std::size_t column, std::size_t row) const { return cells[row * columns + column]; }
};

/// Where the floor is (m, map frame): at the lowest corner of the walls, of those of `room` only when one is given; 0
/// without walls.
double floor_height(const MapSnapshot& map, const Room* room = nullptr);

/// The same for every room of the map, by index: in one pass, as large maps need it.
std::vector<double> floor_heights(const MapSnapshot& map);

/// The floor within `reach_m` of the level way of the pelvis: no furniture stands there. The grid ends where the walked
/// floor ends; its origin is a multiple of the cell. Cells are doubled until there are at most a million. Key poses
/// more than 2 m apart (the suit was restarted in between) are not joined. What lies behind one of the `walls` as seen
/// from the way is left out. Empty without a trajectory.
CellGrid walked_floor(std::span<const TrajectoryPose> trajectory, double cell_m, double reach_m,
                      std::span<const WallStretch> walls = {});

}  // namespace kinemap
