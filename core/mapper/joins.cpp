// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/joins.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

using graph::LandmarkKind;

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
constexpr double kCornerMargin = 0.25;    // m: so near to a corner others may seem to be crossed
constexpr double kStep = 0.3;             // m: parallel walls farther apart than this have one between them
constexpr double kShyOfCorner = 0.2;      // m: a hand stops so far before a corner
constexpr double kShySigma = 0.15;        // m
constexpr double kFlush = 0.02;           // m: a table stands so near to the wall behind it
constexpr double kScreenDepth = 0.06;     // m: a screen hangs so far before its wall
constexpr double kBody = 0.25;            // m: half of a wearer who stands with the back to the wall
constexpr double kThickness = 0.13;       // m: of a partition of which one face was touched
constexpr double kFurnitureSigma = 0.08;  // m
constexpr double kBeyond = 2.5;           // m: farther beyond what was touched nothing is inferred

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
    : state_(state), walls_(walls.stretches), join_max_(config.join_max_m) {
  collect_contents(walls.zone_of_pose);
}

void Joiner::collect_contents(const std::vector<std::size_t>& zone_of_pose) {
  for (const auto& visit : state_.observations) {
    const auto& landmark = state_.graph.landmarks[visit.landmark];
    const std::size_t zone = zone_of_pose[visit.key_pose];
    for (std::size_t c = visit.first_contact; c < visit.first_contact + visit.contacts; ++c)
      contents_.push_back({state_.graph.poses[state_.graph.contacts[c].i].p, kBody, kShySigma, zone, {0, 0, 0}});
    if (landmark.kind != LandmarkKind::Table && landmark.kind != LandmarkKind::Screen) continue;
    const Pose T_map_rectangle = graph::landmark_pose(landmark);
    const bool table = landmark.kind == LandmarkKind::Table;
    const Eigen::Vector3d facing = table ? Eigen::Vector3d(0, 0, 0) : T_map_rectangle.q * Eigen::Vector3d::UnitZ();
    for (const double u : {-0.5, 0.5})
      for (const double v : {-0.5, 0.5})
        contents_.push_back({T_map_rectangle * Eigen::Vector3d(u * landmark.x[4], v * landmark.x[5], 0.0), kFlush,
                             kFurnitureSigma, zone, facing});
  }
}

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
  const double cosine = a.frame.axis.dot(b.frame.axis);
  if (std::abs(cosine) < std::cos(kMinAngle)) return {};
  const double b_before_a = a.frame.distance(0.5 * (b.tail() + b.head()));
  const double a_before_b = b.frame.distance(0.5 * (a.tail() + a.head()));
  // `out`: level, out of the room. Opposite walls lack the one at the end of both; parallel ones the step between them.
  const bool opposite = cosine < 0.0, back = !opposite && b_before_a < 0.0;
  if (opposite ? std::min(b_before_a, a_before_b) < kStep : std::abs(b_before_a) < kStep) return {};
  const Eigen::Vector3d along = (a.frame.axis + (opposite ? -1.0 : 1.0) * b.frame.axis).normalized();
  const Eigen::Vector3d out = back ? Eigen::Vector3d(-along) : along;
  const Eigen::Vector3d head = a.head(), tail = b.tail();
  if (!opposite && along.dot(tail - head) < -kMaxShortening) return {};
  // It stands behind all that is in the room between both walls, and before what was touched from behind it.
  const double touched = opposite ? std::max(out.dot(head), out.dot(tail)) : out.dot(back ? tail : head);
  double limit = touched + (opposite ? kBeyond : std::max(0.0, along.dot(tail - head)));
  const auto between = [&](const Eigen::Vector3d& p) {
    const double da = a.frame.distance(p), db = b.frame.distance(p);
    if (opposite) return da > -0.1 && db > -0.1;
    return back ? da < 0.1 && db > -0.1 : da > -0.1 && db < 0.1;
  };
  double behind = -HUGE_VAL;  // other face
  for (const Stretch& face : walls_) {
    const Eigen::Vector3d middle = 0.5 * (face.head() + face.tail());
    const double d = out.dot(middle);
    if (face.frame.normal.dot(out) < std::cos(kSameHeading) || d < touched - 0.2 || d > limit + kThickness) continue;
    if (!between(middle) && !between(face.head()) && !between(face.tail())) continue;
    limit = d - kThickness, behind = limit;
  }
  double d = touched + kShyOfCorner, sigma = kShySigma;
  for (const Content& c : contents_) {
    if (c.zone != a.zone || !between(c.p)) continue;
    const bool screen = c.facing.dot(out) < -std::cos(kMinAngle);
    const double at = out.dot(c.p) + (screen ? kScreenDepth : c.margin);
    if (at > std::max(d, touched) && at < limit + 0.1)
      d = at, sigma = c.sigma;
    else if (c.sigma == kFurnitureSigma && at > touched - 0.05 && at > d - kShyOfCorner)
      d = std::max(at, touched), sigma = c.sigma;
  }
  if (behind > -HUGE_VAL) d = behind, sigma = kFurnitureSigma;
  d = std::min(d, std::max(limit, touched));
  const double inner = opposite ? 0.0 : kInnerCornerCost;
  Join join{Join::Kind::Inferred, meets(a, out, d), meets(b, out, d), 0.0, sigma};
  join.cost = kInferredCost + inner + prolonging_cost(std::abs(join.head_s - a.touched.hi)) +
              prolonging_cost(std::abs(b.touched.lo - join.tail_s));
  return join;
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
