// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "core/map.hpp"
#include "tools/kinemap/truth.hpp"

namespace kinemap::eval {

/// What true and estimated objects have in common, in the building's frame: enough to say whether one stands for the
/// other.
struct Shape {
  ObjectType type = ObjectType::Wall;
  Eigen::Vector3d centre;
  /// Walls and screens: of the normal; chairs: where the sitter faces; tables: of the long side.
  double heading = 0.0;
  std::array<double, 2> size{};  ///< [long, short]; walls [length, height]; zero when unknown
};

Shape shape_of(const TruthObject& object);
Shape shape_of(const MapObject& object, const Pose& T_truth_map);

/// How many edges of its size are judged: a wall's height is assumed, a chair has none.
std::size_t edge_count(ObjectType type);

/// Estimated less true heading, the nearer way round: in ±π; of tables in ±π/2 (a side has no sense), of square ones in
/// ±π/4.
double heading_difference(const Shape& truth, const Shape& estimate);

/// Its size.
double heading_error(const Shape& truth, const Shape& estimate);

/// Distance of centres in the plane of the floor; of walls: of the true centre across the estimated wall.
double level_error(const Shape& truth, const Shape& estimate);

/// How far an estimate is from a true object, m; infinite when it cannot stand for it: another type, too far away,
/// facing elsewhere.
double matching_cost(const Shape& truth, const Shape& estimate);

}  // namespace kinemap::eval
