// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/joins.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

constexpr double kMinAngle = 0.35;        // rad: flatter intersections are no corners
constexpr double kShortening = 5.0;       // a wall that was touched beyond the corner speaks louder than a gap
constexpr double kMaxShortening = 0.7;    // m: what drift and a hand on its way may make of it
constexpr double kMinLength = 0.2;        // m
constexpr double kSameHeading = 0.15;     // rad: stretches of one wall agree so well
constexpr double kSamePlane = 0.25;       // m
constexpr double kOffPlaneCost = 4.0;     // a metre off the plane speaks as loud as so many metres of gap
constexpr double kStraightCost = 0.5;     // a true corner is preferred to a continuation
constexpr double kInnerCornerCost = 0.8;  // outer corners are commoner than inner ones
constexpr double kDoorway = 0.9;          // m: the wearer walks through a doorway within so much of it ...
constexpr double kDoorwayCost = 0.3;      // there is one in the prolonged part
constexpr double kSpreadCost = 1.5;       // ... and drift widens it, but so much for a metre
constexpr double kOpenFloorCost = 4.0;    // the wearer walked through the prolonged part here and there: no wall
constexpr double kInferredCost = 2.0;     // that a wall was not touched at all
constexpr double kFreeEndCost = 4.4;      // of a partition; rarer than a doorway between its end and the next wall
constexpr double kThickest = 0.4;         // m: of partitions
constexpr double kFacesCross = 0.1;       // m: drift may make one so much thinner than nothing
constexpr double kUneven = 0.7;           // m: hands on its two faces leave a free end at places that differ by so much
constexpr double kFreeEndSigma = 0.15;    // m: hands stop before the end
constexpr double kCornerMargin = 0.25;    // m: so near to a corner others may seem to be crossed

/// Prolonging is likelier the shorter, but once furniture is in the way the length matters less.
double prolonging_cost(double longer) {
  if (longer < 0.0) return -kShortening * longer;
  return longer < 1.0 ? longer : 0.5 + 0.5 * longer;
}

double cross_z(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Where the line {p : n·p = d} meets the plane of `wall`, along it.
double meets(const Stretch& wall, const Eigen::Vector3d& n, double d) {
  return (d - n.dot(wall.frame.origin)) / n.dot(wall.frame.axis);
}

}  // namespace

Joiner::Joiner(const MapState& state, const TouchedWalls& walls, const MapperConfig::Walls& config)
    : state_(state), walls_(walls.stretches), missing_(state, walls), join_max_(config.join_max_m) {}

Join Joiner::corner(const Stretch& a, const Stretch& b) const {
  Eigen::Matrix2d m;
  m.col(0) = a.frame.axis.head<2>();
  m.col(1) = -b.frame.axis.head<2>();
  if (std::abs(m.determinant()) < std::sin(kMinAngle)) return {};
  const Eigen::Vector2d s = m.inverse() * (b.frame.origin - a.frame.origin).head<2>();
  const double inner = cross_z(a.frame.axis, b.frame.axis) < 0.0 ? kInnerCornerCost : 0.0;
  const double cost = prolonging_cost(s[0] - a.touched.hi) + prolonging_cost(b.touched.lo - s[1]) + inner;
  return {Join::Kind::Corner, s[0], s[1], cost, 0.0};
}

Join Joiner::continuation(const Stretch& a, const Stretch& b) const {
  if (a.frame.normal.dot(b.frame.normal) < std::cos(kSameHeading)) return {};
  const double gap = a.frame.along(b.tail()) - a.touched.hi;
  const double off = 0.5 * (std::abs(a.frame.distance(b.tail())) + std::abs(b.frame.distance(a.head())));
  if (off > kSamePlane || gap > join_max_ || gap < -0.3 * std::min(a.length(), b.length())) return {};
  const double cost = prolonging_cost(std::abs(gap)) + kOffPlaneCost * off + kStraightCost;
  return {Join::Kind::Straight, a.touched.hi, b.touched.lo, cost, 0.0};
}

Join Joiner::inferred(const Stretch& a, const Stretch& b) const {
  const auto missing = missing_.between(a, b);
  if (!missing) return {};
  Join join{Join::Kind::Inferred, meets(a, missing->out, missing->offset), meets(b, missing->out, missing->offset), 0.0,
            missing->sigma_m};
  join.cost = kInferredCost + (missing->step ? kInnerCornerCost : 0.0) +
              prolonging_cost(std::abs(join.head_s - a.touched.hi)) +
              prolonging_cost(std::abs(b.touched.lo - join.tail_s));
  return join;
}

/// Round the end of a partition, from one of its faces to the other.
Join Joiner::free_end(const Stretch& a, const Stretch& b) const {
  if (a.frame.normal.dot(b.frame.normal) > -std::cos(kSameHeading)) return {};
  const double thickness = -0.5 * (a.frame.distance(b.tail()) + b.frame.distance(a.head()));
  const double beyond = a.frame.along(b.tail()) - a.touched.hi;
  if (thickness < -kFacesCross || thickness > kThickest || std::abs(beyond) > kUneven) return {};
  const double end = std::max(0.0, beyond);
  return {Join::Kind::Inferred, a.touched.hi + end, b.touched.lo + beyond - end,
          kFreeEndCost + prolonging_cost(std::abs(beyond)), kFreeEndSigma};
}

double Joiner::obstruction(const Stretch& wall, double from, double to, const Stretch& neighbour) const {
  if (to - from < kCornerMargin) return 0.0;
  const Eigen::Vector2d p = wall.frame.point(from).head<2>(), q = wall.frame.point(to).head<2>();
  for (const Stretch& other : walls_) {
    if (&other == &wall || &other == &neighbour) continue;
    const double trim = std::min(kCornerMargin, 0.4 * other.length());
    if (ways_cross(p, q, other.frame.point(other.touched.lo + trim).head<2>(),
                   other.frame.point(other.touched.hi - trim).head<2>()))
      return HUGE_VAL;
  }
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (const Passage& passage : passages(state_, wall.frame, from, to)) {
    const double s = wall.frame.along({passage.p.x(), passage.p.y(), 0.0});
    lo = std::min(lo, s), hi = std::max(hi, s);
  }
  return lo > hi ? 0.0 : std::min(kOpenFloorCost, kDoorwayCost + kSpreadCost * std::max(0.0, hi - lo - kDoorway));
}

Join Joiner::join(std::size_t a, std::size_t b) const {
  const Stretch &wa = walls_[a], &wb = walls_[b];
  if (a == b || wa.zone != wb.zone) return {};
  Join best = corner(wa, wb);
  if (best.kind == Join::Kind::Corner) {
    const double longer_a = best.head_s - wa.touched.hi, longer_b = wb.touched.lo - best.tail_s;
    if (std::max(longer_a, longer_b) > join_max_ || std::min(longer_a, longer_b) < -kMaxShortening ||
        best.head_s < wa.touched.lo + kMinLength || best.tail_s > wb.touched.hi - kMinLength)
      return {};
  } else {
    best = continuation(wa, wb);
    if (best.kind == Join::Kind::None) best = inferred(wa, wb);
    if (best.kind == Join::Kind::None) best = free_end(wa, wb);
    if (best.kind == Join::Kind::None) return {};
  }
  if (best.kind == Join::Kind::Straight) {
    best.cost += obstruction(wa, wa.touched.hi, wa.frame.along(wb.tail()), wb);
  } else {
    best.cost += obstruction(wa, wa.touched.hi, best.head_s - kCornerMargin, wb) +
                 obstruction(wb, best.tail_s + kCornerMargin, wb.touched.lo, wa);
  }
  return best;
}

}  // namespace kinemap
