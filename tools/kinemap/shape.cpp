// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kinemap::eval {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// An estimate further off than this is of no use to anyone as that object.
constexpr double kMaxLevelM = 1.2;
constexpr double kMaxAcrossM = 0.8;
constexpr double kMaxWallTurn = kPi / 6;
constexpr double kMaxScreenTurn = kPi / 3;
constexpr double kSquare = 1.15;  ///< long / short below which nobody can tell the two sides apart

Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }

double table_heading(const MapObject& object) {
  if (!object.corners) return heading_of(object.pose.q);
  const auto& c = *object.corners;
  const Eigen::Vector3d a = c[1] - c[0], b = c[2] - c[1];
  const Eigen::Vector3d& side = a.norm() >= b.norm() ? a : b;
  return std::atan2(side.y(), side.x());
}

double map_heading(const MapObject& object) {
  if (object.type == ObjectType::Table) return table_heading(object);
  if (object.plane) return std::atan2(object.plane->normal.y(), object.plane->normal.x());
  return heading_of(object.pose.q);
}

double wall_cost(const Shape& truth, const Shape& estimate) {
  if (heading_error(truth, estimate) > kMaxWallTurn) return kInfinite;
  const Eigen::Vector2d normal = direction(estimate.heading), along(-normal.y(), normal.x());
  const Eigen::Vector2d offset = (truth.centre - estimate.centre).head<2>();
  const Eigen::Vector2d half = truth.size[0] / 2 * Eigen::Vector2d(-std::sin(truth.heading), std::cos(truth.heading));
  const double across = (std::abs(normal.dot(offset + half)) + std::abs(normal.dot(offset - half))) / 2;
  const double apart = std::abs(along.dot(offset));
  if (across > kMaxAcrossM || apart > (truth.size[0] + estimate.size[0]) / 2) return kInfinite;
  return across + apart / 4;  // the ends of walls depend on their neighbours: they count less
}

}  // namespace

Shape shape_of(const TruthObject& object) {
  return {object.type, object.pose.p, heading_of(object.pose.q), object.size};
}

Shape shape_of(const MapObject& object, const Pose& T_truth_map) {
  Shape shape{object.type, T_truth_map * object.pose.p, wrap_angle(map_heading(object) + heading_of(T_truth_map.q)),
              object.size.value_or(std::array<double, 2>{})};
  if (object.type != ObjectType::Wall) std::sort(shape.size.rbegin(), shape.size.rend());
  return shape;
}

std::size_t edge_count(ObjectType type) { return type == ObjectType::Chair ? 0 : type == ObjectType::Wall ? 1 : 2; }

double heading_difference(const Shape& truth, const Shape& estimate) {
  const bool square = truth.size[0] < kSquare * truth.size[1];
  const double period = truth.type != ObjectType::Table ? 2 * kPi : square ? kPi / 2 : kPi;
  return std::remainder(estimate.heading - truth.heading, period);
}

double heading_error(const Shape& truth, const Shape& estimate) {
  return std::abs(heading_difference(truth, estimate));
}

double level_error(const Shape& truth, const Shape& estimate) {
  const Eigen::Vector2d offset = (truth.centre - estimate.centre).head<2>();
  return truth.type == ObjectType::Wall ? std::abs(direction(estimate.heading).dot(offset)) : offset.norm();
}

double matching_cost(const Shape& truth, const Shape& estimate) {
  if (truth.type != estimate.type) return kInfinite;
  if (truth.type == ObjectType::Wall) return wall_cost(truth, estimate);
  if (level_error(truth, estimate) > kMaxLevelM) return kInfinite;
  if (truth.type == ObjectType::Screen && heading_error(truth, estimate) > kMaxScreenTurn) return kInfinite;
  return (truth.centre - estimate.centre).norm();
}

}  // namespace kinemap::eval
