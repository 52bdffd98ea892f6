// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/free_space.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/mapper/associate.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

using graph::LandmarkKind;

constexpr double kInset = 0.1;        // m: extents err, hands come from the side, bodies bend over edges ...
constexpr double kSigma = 0.12;       // m: ... and so much beyond it
constexpr double kDoorway = 0.5;      // m: a gap between contacts that one may have walked through
constexpr double kStorey = 1.8;       // m: a pelvis is less than this above the floor that its body is on
constexpr double kSameHeight = 0.3;   // m: of tables that exclude each other
constexpr std::size_t kOneTime = 20;  // key poses: intrusions closer to each other have one cause
constexpr double kCertain = 26.0;     // beyond so many sigmas erfc() is 0

/// A thing that nobody can be in, seen from above: a rectangle, inset, or a line where it is upright.
struct Solid {
  std::size_t landmark = 0;
  LandmarkKind kind = LandmarkKind::Table;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero(), u = Eigen::Vector2d::UnitX(), v = Eigen::Vector2d::UnitY();
  double half_u = 0.0;
  double half_v = 0.0;  ///< 0: a line
  double z = 0.0;
  double floor_z = 0.0;
  std::vector<std::size_t> visits = {};  ///< poses from which it was touched, at least one

  /// Where p is, from the centre along u and v.
  [[nodiscard]] Eigen::Vector2d within(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d d = p.head<2>() - centre;
    return {u.dot(d), v.dot(d)};
  }
  /// Whether a body whose pelvis is at p is on the floor that it stands on.
  [[nodiscard]] bool on_its_floor(const Eigen::Vector3d& p) const {
    return p.z() > floor_z && p.z() < floor_z + kStorey;
  }
  [[nodiscard]] double half(const Eigen::Vector2d& axis) const {
    return half_u * std::abs(u.dot(axis)) + half_v * std::abs(v.dot(axis));
  }
};

/// A body where another one is. It would be clear of it, were it moved by `depth` along `axis`; the drift between poses
/// i and j may have done that.
struct Intrusion {
  std::size_t i = 0, j = 0;
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
  double depth = 0.0;
};

std::optional<Solid> rectangle(const MapState& state, std::size_t landmark) {
  const auto& l = state.graph.landmarks[landmark];
  const Pose T = graph::landmark_pose(l);
  Solid s{landmark, l.kind};
  s.centre = T.p.head<2>(), s.z = T.p.z();
  s.u = (T.q * Eigen::Vector3d::UnitX()).head<2>().normalized();
  s.v = {-s.u.y(), s.u.x()};
  s.half_u = 0.5 * l.x[4] - kInset;
  s.half_v = l.kind == LandmarkKind::Table ? 0.5 * l.x[5] - kInset : 0.0;
  return s.half_u > 0.0 && s.half_v >= 0.0 ? std::optional(s) : std::nullopt;
}

/// The stretches of a wall without a gap in which there may be a doorway.
void add_wall(const MapState& state, std::size_t landmark, std::vector<Solid>& out) {
  const WallFrame frame(state.graph.landmarks[landmark]);
  std::vector<double> at;
  for (const auto& visit : state.observations) {
    if (visit.landmark != landmark) continue;
    const auto of_visit = contacts_along(state, visit, frame);
    at.insert(at.end(), of_visit.begin(), of_visit.end());
  }
  std::sort(at.begin(), at.end());
  for (std::size_t begin = 0, end = 0; begin < at.size(); begin = end) {
    for (end = begin + 1; end < at.size() && at[end] - at[end - 1] < kDoorway;) ++end;
    Solid s{landmark, LandmarkKind::Wall};
    s.centre = frame.point(0.5 * (at[begin] + at[end - 1])).head<2>();
    s.u = frame.axis.head<2>(), s.v = frame.normal.head<2>();
    s.half_u = 0.5 * (at[end - 1] - at[begin]) - kInset;
    if (s.half_u > 0.0) out.push_back(s);
  }
}

std::vector<Solid> solids(const MapState& state) {
  std::vector<Solid> out;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    const auto& landmark = state.graph.landmarks[k];
    if (!landmark.active) continue;
    if (landmark.kind == LandmarkKind::Wall) add_wall(state, k, out);
    if (landmark.kind != LandmarkKind::Table && landmark.kind != LandmarkKind::Screen) continue;
    if (const auto s = rectangle(state, k)) out.push_back(*s);
  }
  for (Solid& s : out) {
    s.floor_z = state.landmarks[s.landmark].floor_z;
    for (const auto& visit : state.observations)
      if (visit.landmark == s.landmark) s.visits.push_back(visit.key_pose);
  }
  std::erase_if(out, [](const Solid& s) { return s.visits.empty(); });
  return out;
}

std::vector<Intrusion> walked_through_rectangle(const std::vector<Pose>& poses, const Solid& s) {
  std::vector<Intrusion> found;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector2d at = s.within(poses[k].p).cwiseAbs();
    const double u = s.half_u - at.x(), v = s.half_v - at.y();
    if (std::min(u, v) > 0.0 && s.on_its_floor(poses[k].p)) found.push_back({k, k, u < v ? s.u : s.v, std::min(u, v)});
  }
  return found;
}

/// Going through a line is as deep as it is far to its end, or to where one turned round on either side of it.
std::vector<Intrusion> walked_through_line(const std::vector<Pose>& poses, const Solid& s) {
  std::vector<Intrusion> found;
  std::optional<Intrusion> open;  // through the line; how far the way goes beyond is not known yet
  double reach = 0.0;             // from the line since the plane was last crossed
  const auto close = [&] {
    if (open && reach < open->depth) open->depth = reach, open->axis = s.v;
    if (open) found.push_back(*open);
    open.reset();
  };
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector2d at = s.within(poses[k].p);
    const Eigen::Vector2d before = k == 0 ? at : s.within(poses[k - 1].p);
    if ((before.y() > 0.0) != (at.y() > 0.0)) {
      close();
      const double u = before.x() + (at.x() - before.x()) * before.y() / (before.y() - at.y());
      const double to_end = s.half_u - std::abs(u);
      if (to_end > 0.0 && s.on_its_floor(poses[k].p))
        open = to_end < reach ? Intrusion{k, k, s.u, to_end} : Intrusion{k, k, s.v, reach};
      reach = 0.0;
    }
    reach = std::max(reach, std::abs(at.y()));
  }
  close();
  return found;
}

/// Of those that have one cause the deepest.
std::vector<Intrusion> deepest(const std::vector<Intrusion>& found) {
  std::vector<Intrusion> out;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k == 0 || found[k].i >= found[k - 1].i + kOneTime)
      out.push_back(found[k]);
    else if (found[k].depth > out.back().depth)
      out.back() = found[k];
  }
  return out;
}

bool exclude_each_other(const Solid& a, const Solid& b) {
  if (a.landmark == b.landmark || std::abs(a.floor_z - b.floor_z) > kStorey) return false;
  if (a.kind == LandmarkKind::Wall || b.kind == LandmarkKind::Wall) return true;
  return a.kind == LandmarkKind::Table && b.kind == LandmarkKind::Table && std::abs(a.z - b.z) < kSameHeight;
}

/// Separating axes: the least way that takes them apart.
std::optional<Intrusion> overlap(const Solid& a, const Solid& b) {
  Intrusion least{0, 0, a.u, HUGE_VAL};
  for (const Eigen::Vector2d& axis : {a.u, a.v, b.u, b.v}) {
    const double depth = a.half(axis) + b.half(axis) - std::abs(axis.dot(a.centre - b.centre));
    if (depth < least.depth) least.depth = depth, least.axis = axis;
  }
  return least.depth > 0.0 ? std::optional(least) : std::nullopt;
}

std::size_t nearest(const std::vector<std::size_t>& poses, std::size_t pose) {
  const auto apart = [pose](std::size_t k) { return k > pose ? k - pose : pose - k; };
  return *std::min_element(poses.begin(), poses.end(),
                           [&](std::size_t x, std::size_t y) { return apart(x) < apart(y); });
}

std::vector<Intrusion> intrusions(const MapState& state) {
  const std::vector<Solid> things = solids(state);
  std::vector<Intrusion> out;
  for (std::size_t k = 0; k < things.size(); ++k) {
    for (Intrusion way : deepest(things[k].half_v > 0.0 ? walked_through_rectangle(state.graph.poses, things[k])
                                                        : walked_through_line(state.graph.poses, things[k]))) {
      way.j = nearest(things[k].visits, way.i);
      out.push_back(way);
    }
    for (std::size_t n = k + 1; n < things.size(); ++n) {
      auto both = exclude_each_other(things[k], things[n]) ? overlap(things[k], things[n]) : std::nullopt;
      if (!both) continue;
      both->i = things[k].visits.back();
      both->j = nearest(things[n].visits, both->i);
      out.push_back(*both);
    }
  }
  return out;
}

/// −2 ln of the chance that drift and the errors of extents explain it.
double cost_of(const MapState& state, const graph::Marginals& marginals, const Intrusion& found) {
  const Eigen::Vector3d axis(found.axis.x(), found.axis.y(), 0.0);
  const double variance = kSigma * kSigma + variance_along(state, marginals, found.i, found.j, axis);
  return -2.0 * std::log(std::erfc(std::min(kCertain, found.depth / std::sqrt(2.0 * variance))));
}

}  // namespace

double free_space_cost(const MapState& state, const graph::Marginals* marginals, double most) {
  if (most <= 0.0) return 0.0;
  const auto found = intrusions(state);
  if (found.empty()) return 0.0;
  std::optional<graph::Marginals> own;
  if (!marginals) {
    own = graph::Marginals::compute(state.graph);
    if (!own) return 0.0;
    marginals = &*own;
  }
  double sum = 0.0;
  for (const Intrusion& i : found) sum += std::min(most, cost_of(state, *marginals, i));
  return sum;
}

}  // namespace kinemap
