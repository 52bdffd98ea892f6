// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/map.hpp"

namespace kinemap::cli {

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
    std::string size;  ///< "1.60 × 0.80 m", "4.02 m", or empty
  };
  std::vector<Item> items;
  std::vector<std::vector<Eigen::Vector2d>> rooms;
  std::vector<std::string> room_labels;  ///< "33.9 m²"
  std::vector<Eigen::Vector2d> path;     ///< optimised pelvis, when known
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  double turn_rad = 0.0;  ///< the map frame was turned by this to make the plan
};

/// The plan of a map; without objects and trajectory it is empty and has no extent.
Plan make_plan(const MapSnapshot& map);

/// A stand-alone SVG with labels, sizes and a scale bar.
std::string plan_svg(const Plan& plan);

/// The plan in Braille dots, at most `columns` wide and `rows` high, with ids on the objects, a scale bar and a key.
/// `colour`: ANSI colours.
std::string plan_text(const Plan& plan, int columns, int rows, bool colour);

/// 'T' of "T3" for table 3, and so on: what stands on the plan.
char plan_letter(ObjectType type);

}  // namespace kinemap::cli
