// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/relocate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/mapper/associate.hpp"
#include "core/mapper/compass.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

constexpr double kLoose = 1.0;        // rad: a heading known worse than this is unknown
constexpr double kNear = 0.35;        // m, of objects that are one
constexpr double kNearHeading = 0.3;  // rad
constexpr double kHeight = 0.12;      // m
constexpr double kSize = 0.08;        // m, and a part of the size
constexpr double kSizeShare = 0.1;
constexpr double kBeside = 1.0;      // m that a wall may have been touched beyond where it was before
constexpr double kWallWeight = 0.5;  // walls look more alike than furniture
constexpr double kEnough = 3.0;      // summed weights
constexpr double kMargin = 1.5;      // to the next best way to lay the part
constexpr double kElsewhere = 0.7;   // m, rad: so far apart two ways are not the same one
constexpr double kHeldLevel = 0.3, kHeldHeading = 0.1;  // m, rad: until closures hold it
constexpr double kHalfPi = std::numbers::pi / 2.0;

struct Parts {
  std::vector<std::size_t> before, after;  ///< landmarks
};

struct Fit {
  Pose T;  ///< T_map_part, level
  double weight = 0.0;
  int furniture = 0;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< after, before
};

Parts parts_of(const MapState& state) {
  const std::vector<bool> beyond = beyond_break(state);
  Parts parts;
  for (std::size_t k = 0; k < beyond.size(); ++k) {
    const Landmark& landmark = state.graph.landmarks[k];
    if (landmark.active && landmark.kind != LandmarkKind::Direction)
      (beyond[k] ? parts.after : parts.before).push_back(k);
  }
  return parts;
}

Eigen::Vector3d place(const Landmark& l) { return {l.x[0], l.x[1], l.x[2]}; }

Landmark moved(const Landmark& landmark, const Pose& T) {
  Landmark out = landmark;
  const double turn = heading_of(T.q);
  if (landmark.kind == LandmarkKind::Wall) {
    out.anchor = T * landmark.anchor;
    out.x[0] = wrap_angle(landmark.x[0] + turn);
    return out;
  }
  const Eigen::Vector3d p = T * place(landmark);
  out.x[0] = p.x(), out.x[1] = p.y(), out.x[2] = p.z();
  out.x[3] = wrap_angle(landmark.x[3] + turn);
  return out;
}

/// Quarter turns by which the axes of two like tables may differ; other things have one way round.
std::vector<int> ways_round(const Landmark& a, const Landmark& b) {
  const auto alike = [](double x, double y) { return std::abs(x - y) < kSize + kSizeShare * y; };
  if (a.kind != b.kind || std::abs(a.x[2] - b.x[2]) > kHeight) return {};
  if (a.kind == LandmarkKind::Seat) return {0};
  const bool same = alike(a.x[4], b.x[4]) && alike(a.x[5], b.x[5]);
  if (a.kind == LandmarkKind::Screen) return same ? std::vector<int>{0} : std::vector<int>{};
  std::vector<int> ways;
  if (same) ways = {0, 2};
  if (alike(a.x[4], b.x[5]) && alike(a.x[5], b.x[4])) ways.insert(ways.end(), {1, 3});
  return ways;
}

bool same_furniture(const Landmark& a, const Landmark& b) {
  if ((place(a) - place(b)).norm() > kNear) return false;
  const auto ways = ways_round(a, b);
  return std::any_of(ways.begin(), ways.end(),
                     [&](int way) { return std::abs(wrap_angle(a.x[3] - b.x[3] - way * kHalfPi)) < kNearHeading; });
}

bool same_wall(const MapState& state, std::size_t after, std::size_t before, const Pose& T) {
  const Landmark& known = state.graph.landmarks[before];
  const Landmark wall = moved(state.graph.landmarks[after], T);
  const auto touched = contact_interval(state, after), there = contact_interval(state, before);
  if (!touched || !there || std::abs(wrap_angle(wall.x[0] - known.x[0])) > kNearHeading) return false;
  const Eigen::Vector3d middle = WallFrame(wall).point(0.5 * (touched->lo + touched->hi));
  const WallFrame frame(known);
  const double along = frame.along(middle);
  return std::abs(frame.distance(middle)) < kNear && along > there->lo - kBeside && along < there->hi + kBeside;
}

Fit fit_of(const MapState& state, const Parts& parts, const Pose& T) {
  Fit fit{T, 0.0, 0, {}};
  std::vector<bool> taken(state.graph.landmarks.size(), false);
  for (const std::size_t a : parts.after) {
    const Landmark& landmark = state.graph.landmarks[a];
    const bool wall = landmark.kind == LandmarkKind::Wall;
    const Landmark there = wall ? landmark : moved(landmark, T);
    const auto known = std::find_if(parts.before.begin(), parts.before.end(), [&](std::size_t b) {
      const Landmark& other = state.graph.landmarks[b];
      if (taken[b] || other.kind != landmark.kind) return false;
      return wall ? same_wall(state, a, b, T) : same_furniture(there, other);
    });
    if (known == parts.before.end()) continue;
    taken[*known] = true;
    fit.weight += wall ? kWallWeight : 1.0;
    if (wall) continue;
    ++fit.furniture;
    fit.pairs.emplace_back(a, *known);
  }
  return fit;
}

/// The level move that lays the paired furniture on each other best (least squares in the plane); the heading of the
/// fit counts where it is one piece only.
Pose refined(const MapState& state, const Fit& fit) {
  if (fit.pairs.size() < 2) return fit.T;
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = from;
  for (const auto& [a, b] : fit.pairs) {
    from += place(state.graph.landmarks[a]).head<2>();
    to += place(state.graph.landmarks[b]).head<2>();
  }
  from /= static_cast<double>(fit.pairs.size()), to /= static_cast<double>(fit.pairs.size());
  double sine = 0.0, cosine = 0.0;
  for (const auto& [a, b] : fit.pairs) {
    const Eigen::Vector2d u = place(state.graph.landmarks[a]).head<2>() - from;
    const Eigen::Vector2d v = place(state.graph.landmarks[b]).head<2>() - to;
    cosine += u.dot(v), sine += u.x() * v.y() - u.y() * v.x();
  }
  Pose T = level_pose(Eigen::Vector3d::Zero(), std::atan2(sine, cosine));
  const Eigen::Vector3d turned = T.q * Eigen::Vector3d(from.x(), from.y(), 0.0);
  T.p = Eigen::Vector3d(to.x() - turned.x(), to.y() - turned.y(), 0.0);
  return T;
}

/// Every way to lay one piece of furniture seen after the break on a like one seen before.
std::vector<Fit> all_fits(const MapState& state, const Parts& parts) {
  std::vector<Fit> fits;
  for (const std::size_t a : parts.after) {
    for (const std::size_t b : parts.before) {
      const Landmark& x = state.graph.landmarks[a];
      const Landmark& y = state.graph.landmarks[b];
      if (x.kind == LandmarkKind::Wall) continue;
      for (const int way : ways_round(x, y)) {
        Pose T = level_pose(Eigen::Vector3d::Zero(), wrap_angle(y.x[3] - x.x[3] + way * kHalfPi));
        T.p = place(y) - T.q * place(x);
        T.p.z() = 0.0;
        const Fit rough = fit_of(state, parts, T);
        const Fit fine = fit_of(state, parts, refined(state, rough));
        fits.push_back(fine.weight >= rough.weight ? fine : rough);
      }
    }
  }
  return fits;
}

}  // namespace

std::optional<std::size_t> open_break(const graph::Graph& graph) {
  for (std::size_t k = graph.between.size(); k-- > graph.first_free_pose;)
    if (const double heading = graph.between[k].sqrt_information(5, 5); heading > 0.0 && heading < 1.0 / kLoose)
      return k;
  return std::nullopt;
}

std::vector<bool> beyond_break(const MapState& state) {
  const auto broken = open_break(state.graph);
  if (!broken) return {};
  std::vector<bool> beyond(state.graph.landmarks.size(), false);
  for (const auto& visit : state.observations)
    beyond[visit.landmark] = visit.key_pose >= state.graph.between[*broken].j;
  return beyond;
}

std::optional<Pose> find_relocation(const MapState& state) {
  if (!open_break(state.graph)) return std::nullopt;
  const Parts parts = parts_of(state);
  const auto fits = all_fits(state, parts);
  const auto lighter = [](const Fit& x, const Fit& y) { return x.weight < y.weight; };
  const auto best = std::max_element(fits.begin(), fits.end(), lighter);
  if (best == fits.end() || best->weight < kEnough || best->furniture < 2) return std::nullopt;
  const Eigen::Vector3d here = place(state.graph.landmarks[best->pairs.front().first]);
  const bool clear = std::all_of(fits.begin(), fits.end(), [&](const Fit& other) {
    const bool same =
        (other.T * here - best->T * here).norm() < kElsewhere && other.T.q.angularDistance(best->T.q) < kElsewhere;
    return same || other.weight <= best->weight - kMargin;
  });
  return clear ? std::optional(best->T) : std::nullopt;
}

void relocate(MapState& state, const Pose& T_map_part) {
  const auto broken = open_break(state.graph);
  if (!broken) return;
  const Parts parts = parts_of(state);
  for (const std::size_t k : parts.after) state.graph.landmarks[k] = moved(state.graph.landmarks[k], T_map_part);
  graph::BetweenFactor& way = state.graph.between[*broken];
  for (std::size_t i = way.j; i < state.graph.poses.size(); ++i)
    state.graph.poses[i] = T_map_part * state.graph.poses[i];
  turn_norths(state.graph, way.j, heading_of(T_map_part.q));
  way.T_i_j = state.graph.poses[way.i].inverse() * state.graph.poses[way.j];
  for (const int k : {0, 1}) way.sqrt_information(k, k) = 1.0 / kHeldLevel;
  way.sqrt_information(5, 5) = 1.0 / kHeldHeading;
}

}  // namespace kinemap
