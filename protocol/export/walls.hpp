// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/map.hpp"

/// Walls as drawings, grids and simulators need them: cut open where the wearer walked through.
namespace kinemap {

/// A doorway is drawn so wide: only where it is was observed.
constexpr double kDoorwayWidth = 0.8;
/// A wall is drawn so thick, behind the face that was touched: only that face was observed.
constexpr double kWallThickness = 0.1;

/// A part of a wall between its ends and its doorways, map frame, m; the face that was touched is on the left of a → b.
struct WallStretch {
  std::uint32_t wall_id = 0;  ///< 0: nobody touched it, but it must be there (Room::inferred_sides)
  bool open = false;          ///< a doorway
  Eigen::Vector2d a, b;
  double bottom_z = 0.0, top_z = 0.0;
  /// Where the wall meets another one in a corner: how much longer its back is than its face, as a part of the
  /// thickness.
  double mitre_a = 0.0, mitre_b = 0.0;

  [[nodiscard]] double length() const { return (b - a).norm(); }
  [[nodiscard]] Eigen::Vector2d along() const { return (b - a).normalized(); }
  [[nodiscard]] Eigen::Vector2d normal() const { return {-along().y(), along().x()}; }  ///< unit, into the room
  /// The corners of the wall seen from above, counter-clockwise from a: a, the back `thickness` behind the face, b.
  [[nodiscard]] std::array<Eigen::Vector2d, 4> outline(double thickness) const;
};

/// The inferred sides of the rooms (id 0), then all walls by id, each from one end to the other.
std::vector<WallStretch> wall_stretches(const MapSnapshot& map);

/// Those of one wall.
std::span<const WallStretch> stretches_of(std::span<const WallStretch> stretches, std::uint32_t wall_id);

/// The ends of an upright object's face seen from above, its normal on the left of the way from the first to the
/// second. The object must have a plane and corners.
std::array<Eigen::Vector2d, 2> ends_of(const MapObject& upright);

}  // namespace kinemap
