// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/rectangle.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/landmarks/corners.hpp"
#include "core/landmarks/geometry.hpp"
#include "core/landmarks/sides.hpp"
#include "core/pose.hpp"

namespace kinemap {
namespace {

using graph::Edge;
using Points = std::span<const Eigen::Vector2d>;

constexpr double kCauchyScale = 0.03;  // m: beyond it a contact counts less and less (rounded corners, lift-offs)

Eigen::Rotation2Dd rotation(double heading) { return Eigen::Rotation2Dd(heading); }
bool is_u(Edge e) { return e == Edge::MinusU || e == Edge::PlusU; }
bool is_plus(Edge e) { return e == Edge::PlusU || e == Edge::PlusV; }
std::size_t slot(Edge e) { return static_cast<std::size_t>(e) - 1; }
constexpr std::array<Edge, 4> kEdges{Edge::MinusU, Edge::PlusU, Edge::MinusV, Edge::PlusV};

/// Heading of the sides, modulo 90°: mean of four times the angle over the chords between corners, by length.
std::optional<double> dominant_heading(Points points, const std::vector<std::size_t>& corners) {
  std::vector<std::size_t> cuts{0};
  cuts.insert(cuts.end(), corners.begin(), corners.end());
  cuts.push_back(points.size() - 1);
  double s = 0.0, c = 0.0;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    if (cuts[k] < cuts[k - 1] + 3) continue;
    const auto side = fit_line(points.subspan(cuts[k - 1], cuts[k] - cuts[k - 1] + 1));
    if (!side) continue;
    const double length = (points[cuts[k]] - points[cuts[k - 1]]).norm();
    const double angle = 4.0 * std::atan2(side->direction.y(), side->direction.x());
    s += length * length * std::sin(angle), c += length * length * std::cos(angle);
  }
  if (s == 0.0 && c == 0.0) return std::nullopt;
  return std::atan2(s, c) / 4.0;
}

/// Splits the positions of contacts that travel along one axis into the two opposite sides: {minus, plus}, either may
/// be empty. `other_mean` is where the contacts of the crossing sides lie on this axis; it tells which side a lone one
/// is.
struct Split {
  std::optional<double> minus, plus;
};
Split split_sides(const std::vector<double>& positions, double other_mean, double min_apart) {
  if (positions.size() < 3) return {};
  const auto [lo, hi] = std::minmax_element(positions.begin(), positions.end());
  const double middle = 0.5 * (*lo + *hi);
  std::vector<double> low, high;
  for (const double x : positions) (x < middle ? low : high).push_back(x);
  const auto enough = std::max<std::size_t>(3, positions.size() / 12);
  if (low.size() >= enough && high.size() >= enough && median(high) - median(low) >= min_apart)
    return {median(low), median(high)};
  const double at = median(positions);
  return at < other_mean ? Split{at, std::nullopt} : Split{std::nullopt, at};
}

struct Bounds {                // of the rectangle in the rotated frame
  std::array<double, 4> at{};  // MinusU, PlusU, MinusV, PlusV
  std::array<bool, 4> drawn{};
};

/// Bounds in the frame turned by `heading`, from the directions of travel; the sides that were not drawn come from the
/// ends of the trace: they are the two points farthest apart, over whose diagonal the known corner is mirrored.
std::optional<Bounds> initial_bounds(const std::vector<Eigen::Vector2d>& local,
                                     const std::vector<Eigen::Vector2d>& travel, const LandmarkConfig& config) {
  std::vector<double> along_u, along_v;  // v of contacts that travel along u, and the other way round
  double mean_u = 0.0, mean_v = 0.0;
  for (std::size_t i = 0; i < local.size(); ++i) {
    mean_u += local[i].x() / static_cast<double>(local.size());
    mean_v += local[i].y() / static_cast<double>(local.size());
    if (std::abs(travel[i].x()) > 0.85) along_u.push_back(local[i].y());
    if (std::abs(travel[i].y()) > 0.85) along_v.push_back(local[i].x());
  }
  const double min_apart = 0.8 * config.rectangle_min_side_m;
  const Split u = split_sides(along_v, mean_u, min_apart), v = split_sides(along_u, mean_v, min_apart);
  Bounds bounds;
  bounds.drawn = {u.minus.has_value(), u.plus.has_value(), v.minus.has_value(), v.plus.has_value()};
  const bool any_u = bounds.drawn[0] || bounds.drawn[1], any_v = bounds.drawn[2] || bounds.drawn[3];
  if (!any_u || !any_v) return std::nullopt;
  const auto [a, b] = farthest_pair(local);
  const Eigen::Vector2d corner(u.minus ? *u.minus : *u.plus, v.minus ? *v.minus : *v.plus);
  const Eigen::Vector2d opposite = fourth_corner(corner, local[a], local[b]);
  bounds.at = {u.minus.value_or(opposite.x()), u.plus.value_or(opposite.x()), v.minus.value_or(opposite.y()),
               v.plus.value_or(opposite.y())};
  if (bounds.at[0] > bounds.at[1] || bounds.at[2] > bounds.at[3]) return std::nullopt;
  return bounds;
}

/// Each contact to the side that the hand was on, if it was drawn; none in corners, which people cut.
void assign_sides(Points points, IndexRange kept, const std::vector<Eigen::Vector2d>& travel, RectangleFit& fit) {
  fit.labels.assign(points.size(), {});
  const auto turn = rotation(-fit.heading);
  std::vector<SideQuery> contacts;
  for (std::size_t i = kept.begin; i < kept.end; ++i)
    contacts.push_back({to_local(fit, points[i]), turn * travel[i], Edge::None});
  const SideCosts costs;
  const auto sides = choose_sides(contacts, fit.size, fit.drawn, costs, false);
  for (std::size_t k = 0; k < sides.size(); ++k)
    if (sides[k] != Edge::None && !in_corner(contacts[k].p, fit.size, fit.drawn, sides[k], costs))
      fit.labels[kept.begin + k].edge = sides[k];
}

/// A side that was followed over less than this part of its length, at one end of the trace only, is the reach to the
/// corner or from it.
constexpr double kMinCoverage = 0.5;

/// First and last point of `side` along it, as a part of its length.
double coverage(Points points, const RectangleFit& fit, Edge side) {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.labels[i].edge != side) continue;
    const Eigen::Vector2d local = to_local(fit, points[i]);
    const double along = is_u(side) ? local.y() : local.x();
    lo = std::min(lo, along), hi = std::max(hi, along);
  }
  return hi > lo ? (hi - lo) / fit.size[is_u(side) ? 1 : 0] : 0.0;
}

/// The part of `kept` that remains when short ends on a side of their own are cut off; such sides count as not drawn.
/// The hand comes to a corner and leaves it along any way, often along a side; if it really drew the beginning of that
/// side, only this little is lost.
IndexRange without_stubs(Points points, IndexRange kept, RectangleFit& fit) {
  for (const Edge side : kEdges) {
    if (!fit.drawn[slot(side)] || std::count(fit.drawn.begin(), fit.drawn.end(), true) <= 2) continue;
    if (coverage(points, fit, side) >= kMinCoverage) continue;
    std::size_t first = points.size(), last = 0, front = kept.end, back = kept.begin;
    for (std::size_t i = kept.begin; i < kept.end; ++i) {
      const Edge edge = fit.labels[i].edge;
      if (edge == side)
        first = std::min(first, i), last = i;
      else if (edge != Edge::None)
        front = std::min(front, i), back = i;
    }
    if (first > last) {
      fit.drawn[slot(side)] = false;  // the hand was never on it
      continue;
    }
    if (last < front)
      kept.begin = last + 1;
    else if (first > back)
      kept.end = first;
    else
      continue;  // in the middle of the trace it was really followed
    fit.drawn[slot(side)] = false;
  }
  return kept;
}

/// The ends of an open contour lie in corners: the outermost contact there is also on the side that was not drawn.
void assign_end_corners(Points points, IndexRange kept, RectangleFit& fit) {
  for (const Edge missing : kEdges) {
    if (fit.drawn[slot(missing)]) continue;
    for (const Edge side : kEdges) {
      if (is_u(side) == is_u(missing) || !fit.drawn[slot(side)]) continue;
      std::optional<std::size_t> end;
      double outermost = -HUGE_VAL;
      for (std::size_t i = kept.begin; i < kept.end; ++i) {
        if (fit.labels[i].edge != side) continue;
        const Eigen::Vector2d local = to_local(fit, points[i]);
        const double out = (is_plus(missing) ? 1.0 : -1.0) * (is_u(missing) ? local.x() : local.y());
        if (out > outermost) outermost = out, end = i;
      }
      if (end) fit.labels[*end] = {side, missing};
    }
  }
}

/// One Gauss-Newton step on (centre, heading, size) with Cauchy weights. Returns false when the sides leave a number
/// open.
bool refine(Points points, RectangleFit& fit, bool free_heading) {
  Eigen::Matrix<double, 5, 5> h = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> g = Eigen::Matrix<double, 5, 1>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d local = to_local(fit, points[i]);
    const auto add = [&](Edge e, double weight) {
      if (e == Edge::None) return;
      const double r = side_error(local, fit.size, e);
      Eigen::Matrix<double, 5, 1> j = Eigen::Matrix<double, 5, 1>::Zero();
      j[is_u(e) ? 0 : 1] = -1.0;  // centre, moved along the local axes
      j[2] = is_u(e) ? local.y() : -local.x();
      j[is_u(e) ? 3 : 4] = is_plus(e) ? -0.5 : 0.5;
      const double w = weight / (1.0 + r * r / (kCauchyScale * kCauchyScale));
      h += w * j * j.transpose(), g += w * r * j;
    };
    add(fit.labels[i].edge, 1.0);
    add(fit.labels[i].corner, 4.0);  // one contact stands for a whole side
  }
  if (!free_heading) h(2, 2) += 1e12;
  const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> ldlt(h);
  if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() < 1e-9 * h.trace() / 1e12) return false;
  const Eigen::Matrix<double, 5, 1> step = -ldlt.solve(g);
  if (!step.allFinite()) return false;
  fit.centre += rotation(fit.heading) * step.head<2>();
  if (free_heading) fit.heading += std::clamp(step[2], -0.2, 0.2);
  fit.size[0] += step[3], fit.size[1] += step[4];
  return fit.size[0] > 0.0 && fit.size[1] > 0.0;
}

void measure_residual(Points points, RectangleFit& fit) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.labels[i].edge == Edge::None) continue;
    const double r = side_error(to_local(fit, points[i]), fit.size, fit.labels[i].edge);
    sum += std::min(r * r, 0.01), ++n;
  }
  fit.rms = n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
}

}  // namespace

Eigen::Vector2d to_local(const RectangleFit& fit, const Eigen::Vector2d& p) {
  return rotation(-fit.heading) * (p - fit.centre);
}

std::optional<RectangleFit> fit_rectangle(Points points, const LandmarkConfig& config,
                                          std::optional<double> fixed_heading) {
  if (points.size() < 8) return std::nullopt;
  auto heading = fixed_heading;
  if (!heading)
    heading = dominant_heading(points, find_corners(points, config.corner_window_m, config.corner_angle_rad));
  if (!heading) return std::nullopt;

  const auto travel = travel_directions(points, 0.3 * config.corner_window_m);
  std::vector<Eigen::Vector2d> local, local_travel;
  for (std::size_t i = 0; i < points.size(); ++i) {
    local.push_back(rotation(-*heading) * points[i]);
    local_travel.push_back(rotation(-*heading) * travel[i]);
  }
  const auto bounds = initial_bounds(local, local_travel, config);
  if (!bounds) return std::nullopt;

  RectangleFit fit;
  fit.heading = *heading;
  fit.centre = rotation(*heading) *
               Eigen::Vector2d(0.5 * (bounds->at[0] + bounds->at[1]), 0.5 * (bounds->at[2] + bounds->at[3]));
  fit.size = {bounds->at[1] - bounds->at[0], bounds->at[3] - bounds->at[2]};
  fit.drawn = bounds->drawn;
  IndexRange kept{0, points.size()};
  for (int round = 0; round < 8; ++round) {
    assign_sides(points, kept, travel, fit);
    const IndexRange shorter = without_stubs(points, kept, fit);
    if (shorter.begin != kept.begin || shorter.end != kept.end) assign_sides(points, kept = shorter, travel, fit);
    assign_end_corners(points, kept, fit);
    if (!refine(points, fit, !fixed_heading)) return std::nullopt;
  }
  fit.closed = std::all_of(fit.drawn.begin(), fit.drawn.end(), [](bool d) { return d; });
  for (const double side : fit.size)
    if (side < config.rectangle_min_side_m || side > config.rectangle_max_side_m) return std::nullopt;
  measure_residual(points, fit);
  return fit;
}

}  // namespace kinemap
