// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/export/walls.hpp"

namespace kinemap {

/// A floor plan in the plane of the paper: metres, x to the right, y up, turned so that the walls run level and upright
/// and the longer side lies across.
struct Plan {
  /// One object seen from above: an outline, closed (tables) or one stroke (walls, screens); chairs: four corners of
  /// the seat.
  struct Item {
    ObjectType type = ObjectType::Wall;
    std::uint32_t id = 0;
    std::vector<Eigen::Vector2d> outline;
    Eigen::Vector2d centre;
    Eigen::Vector2d
        front;  ///< unit: walls and screens: the side that was touched; chairs: where the sitter faces; else zero
    std::string size;                        ///< "1.60 × 0.80 m", "4.02 m", or empty
    std::string detail;                      ///< all that is known of it, in words
    [[nodiscard]] std::string name() const;  ///< "T3"
  };
  struct Floor {
    std::uint32_t id = 0;
    std::vector<Eigen::Vector2d> polygon;  ///< counter-clockwise
    double area_m2 = 0.0;
  };
  std::vector<Item> items;
  std::vector<WallStretch> walls;  ///< what of the walls is solid, and the doorways
  std::vector<Floor> rooms;
  std::vector<Eigen::Vector2d> path;  ///< optimised pelvis, when known
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  double turn_rad = 0.0;  ///< the map frame was turned by this to make the plan
  std::uint64_t revision = 0;
};

/// The plan of a map; without objects and trajectory it is empty and has no extent.
Plan make_plan(const MapSnapshot& map);

/// A stand-alone SVG: rooms with their areas, walls with dimension lines, sizes of tables and screens, doorways, scale
/// bar, axes of the map frame. Printed at 100 % it is to scale. Pointing at an object shows all that is known of it.
std::string plan_svg(const MapSnapshot& map);

}  // namespace kinemap
