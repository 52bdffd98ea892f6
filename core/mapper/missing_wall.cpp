// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/missing_wall.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

using graph::LandmarkKind;

constexpr double kParallel = 0.35;        // rad
constexpr double kStep = 0.3;             // m: parallel walls farther apart than this have one between them
constexpr double kOverlap = 0.7;          // m: parallel walls with a step between them overlap at most so far
constexpr double kBeyond = 2.5;           // m: farther beyond what was touched nothing is inferred
constexpr double kTolerance = 0.1;        // m: of what is drawn to stand between two walls
constexpr double kShyOfCorner = 0.2;      // m: a hand stops so far before a corner
constexpr double kShySigma = 0.15;        // m
constexpr double kFlush = 0.02;           // m: a table stands so near to the wall behind it
constexpr double kScreenDepth = 0.06;     // m: a screen hangs so far before its wall
constexpr double kFurnitureSigma = 0.08;  // m
constexpr double kBeside = 1.0;           // m: furniture begins so near to where hand and body had to stop
constexpr double kThickness = 0.13;       // m: of a partition of which one face was touched
constexpr double kBody = 0.4;             // m: the wearer's middle keeps about so far from a wall
constexpr double kBodySigma = 0.3;        // m

}  // namespace

/// What is between the head of a and the tail of b; distances are along `out`.
struct MissingWalls::Gap {
  const Stretch& a;
  const Stretch& b;
  Eigen::Vector3d out;
  bool opposite = false;  ///< a and b look at each other
  bool back = false;      ///< parallel, and b steps back from a: the step looks along the walls
  double touched = 0.0;   ///< the farthest that was touched before the missing wall
  double limit = 0.0;     ///< it is nearer than this

  [[nodiscard]] bool holds(const Eigen::Vector3d& p) const {
    const double da = a.frame.distance(p), db = b.frame.distance(p);
    if (opposite) return da > -kTolerance && db > -kTolerance;
    return back ? da < kTolerance && db > -kTolerance : da > -kTolerance && db < kTolerance;
  }
};

MissingWalls::MissingWalls(const MapState& state, const TouchedWalls& walls)
    : poses_(state.graph.poses), walls_(walls) {
  for (const auto& visit : state.observations) {
    const auto& landmark = state.graph.landmarks[visit.landmark];
    if (landmark.kind != LandmarkKind::Table && landmark.kind != LandmarkKind::Screen) continue;
    const Pose T_map_rectangle = graph::landmark_pose(landmark);
    Furniture thing{{}, Eigen::Vector3d::Zero(), walls.zone_of_pose[visit.key_pose]};
    if (landmark.kind == LandmarkKind::Screen) thing.facing = T_map_rectangle.q * Eigen::Vector3d::UnitZ();
    const double u = 0.5 * landmark.x[4], v = 0.5 * landmark.x[5];
    thing.corners = {T_map_rectangle * Eigen::Vector3d(u, v, 0.0), T_map_rectangle * Eigen::Vector3d(-u, v, 0.0),
                     T_map_rectangle * Eigen::Vector3d(-u, -v, 0.0), T_map_rectangle * Eigen::Vector3d(u, -v, 0.0)};
    furniture_.push_back(thing);
  }
}

double MissingWalls::furniture(const Gap& gap) const {
  double farthest = -HUGE_VAL;
  for (const Furniture& thing : furniture_) {
    if (thing.zone != gap.a.zone) continue;
    const bool hangs = thing.facing.dot(gap.out) < -std::cos(kParallel);
    double near = HUGE_VAL, far = -HUGE_VAL;
    bool between = true;
    for (const Eigen::Vector3d& corner : thing.corners) {
      const double at = gap.out.dot(corner) + (hangs ? kScreenDepth : kFlush);
      near = std::min(near, at), far = std::max(far, at);
      between = between && gap.holds(corner);
    }
    if (between && near < gap.touched + kBeside && far < gap.limit + kTolerance) farthest = std::max(farthest, far);
  }
  return farthest;
}

std::optional<double> MissingWalls::partition(const Gap& gap) const {
  std::optional<double> nearest;
  for (const Stretch& face : walls_.stretches) {
    const Eigen::Vector3d middle = 0.5 * (face.head() + face.tail());
    const double at = gap.out.dot(middle) - kThickness;
    if (face.frame.normal.dot(gap.out) < std::cos(kParallel) || at < gap.touched - kShyOfCorner - kThickness ||
        at > gap.limit)
      continue;
    if (!gap.holds(middle) && !gap.holds(face.head()) && !gap.holds(face.tail())) continue;
    nearest = std::min(at, nearest.value_or(at));
  }
  return nearest;
}

double MissingWalls::walked(const Gap& gap) const {
  double farthest = -HUGE_VAL;
  for (std::size_t k = 0; k < poses_.size(); ++k)
    if (walls_.zone_of_pose[k] == gap.a.zone && gap.holds(poses_[k].p))
      farthest = std::max(farthest, gap.out.dot(poses_[k].p));
  return farthest < gap.limit ? farthest : -HUGE_VAL;  // who went on went through a door
}

std::optional<MissingWall> MissingWalls::between(const Stretch& a, const Stretch& b) const {
  const double cosine = a.frame.axis.dot(b.frame.axis);
  if (std::abs(cosine) < std::cos(kParallel)) return std::nullopt;
  const double b_before_a = a.frame.distance(0.5 * (b.tail() + b.head()));
  const double a_before_b = b.frame.distance(0.5 * (a.tail() + a.head()));
  const bool opposite = cosine < 0.0, back = !opposite && b_before_a < 0.0;
  if (opposite ? std::min(b_before_a, a_before_b) < kStep : std::abs(b_before_a) < kStep) return std::nullopt;
  const Eigen::Vector3d along = (a.frame.axis + (opposite ? -1.0 : 1.0) * b.frame.axis).normalized();
  const double overlap = along.dot(a.head() - b.tail());
  if (!opposite && overlap > kOverlap) return std::nullopt;

  Gap gap{a, b, back ? Eigen::Vector3d(-along) : along, opposite, back, 0.0, 0.0};
  const double head = gap.out.dot(a.head()), tail = gap.out.dot(b.tail());
  gap.touched = opposite ? std::max(head, tail) : back ? tail : head;
  gap.limit = gap.touched + (opposite ? kBeyond : std::max(0.0, -overlap));
  MissingWall wall{gap.out, 0.0, kFurnitureSigma, !opposite};
  if (const auto face = partition(gap)) {
    wall.offset = std::max(*face, gap.touched);
  } else if (const double things = furniture(gap), way = walked(gap); things > std::max(gap.touched, way)) {
    wall.offset = things;
  } else if (way + kBody > gap.touched + kShyOfCorner) {
    wall.offset = way + kBody, wall.sigma_m = kBodySigma;
  } else {
    wall.offset = gap.touched + kShyOfCorner, wall.sigma_m = kShySigma;
  }
  wall.offset = std::min(wall.offset, gap.limit);
  return wall;
}

}  // namespace kinemap
