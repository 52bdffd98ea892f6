// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/walls.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assignment.hpp"
#include "core/mapper/associate.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

constexpr double kMinAngle = 0.35;      // rad: flatter intersections are no corners
constexpr double kShortening = 3.0;     // a wall that was touched beyond the corner speaks louder against it than a gap
constexpr double kMaxShortening = 0.4;  // m: what drift and a hand on its way may make of it
constexpr double kCrossingCost = 1.0;   // the wearer walked through the prolonged part: a doorway, or no wall
constexpr double kMinLength = 0.2;      // m
constexpr double kSameHeading = 0.15;   // rad: stretches of one wall agree so well
constexpr double kSamePlane = 0.25;     // m
constexpr double kOffPlaneCost = 4.0;   // a metre off the plane speaks as loud as so many metres of gap
constexpr double kJoinCost = 0.5;       // a true corner is preferred to a continuation
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Stretch {
  std::size_t landmark;
  WallFrame frame;
  Interval touched;

  [[nodiscard]] double length() const { return touched.hi - touched.lo; }
};

struct Meeting {
  double head_s = 0.0;  ///< on the wall that ends there
  double tail_s = 0.0;  ///< on the wall that begins there
  double cost = kNever;
  bool straight = false;  ///< b continues a
};

/// The corner where the head of `a` meets the tail of `b`.
Meeting corner(const Stretch& a, const Stretch& b, double join_max) {
  Eigen::Matrix2d m;
  m.col(0) = a.frame.axis.head<2>();
  m.col(1) = -b.frame.axis.head<2>();
  if (std::abs(m.determinant()) < std::sin(kMinAngle)) return {};
  const Eigen::Vector2d s = m.inverse() * (b.frame.origin - a.frame.origin).head<2>();
  const double longer_a = s[0] - a.touched.hi, longer_b = b.touched.lo - s[1];
  const auto cost = [](double longer) { return longer >= 0.0 ? longer : -kShortening * longer; };
  if (std::max(longer_a, longer_b) > join_max || std::min(longer_a, longer_b) < -kMaxShortening ||
      s[0] < a.touched.lo + kMinLength || s[1] > b.touched.hi - kMinLength)
    return {};
  return {s[0], s[1], cost(longer_a) + cost(longer_b), false};
}

/// `b` goes on where `a` ends, in the same plane and on the same side.
Meeting continuation(const Stretch& a, const Stretch& b, double join_max) {
  if (a.frame.normal.dot(b.frame.normal) < std::cos(kSameHeading)) return {};
  const Eigen::Vector3d head = a.frame.point(a.touched.hi), tail = b.frame.point(b.touched.lo);
  const double gap = a.frame.along(tail) - a.touched.hi;
  const double off = 0.5 * (std::abs(a.frame.distance(tail)) + std::abs(b.frame.distance(head)));
  if (off > kSamePlane || gap > join_max || gap < -0.5 * std::min(a.length(), b.length())) return {};
  return {a.touched.hi, b.touched.lo, std::abs(gap) + kOffPlaneCost * off + kJoinCost, true};
}

Meeting meeting(const Stretch& a, const Stretch& b, double join_max) {
  const Meeting at = corner(a, b, join_max);
  return at.cost < kNever ? at : continuation(a, b, join_max);
}

/// Does the way from p to q cross the way from r to s? (level)
bool cross(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r, const Eigen::Vector3d& s) {
  const auto side = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  return side(p, q, r) * side(p, q, s) < 0.0 && side(r, s, p) * side(r, s, q) < 0.0;
}

/// Did the wearer walk through the straight way from p to q?
bool walked_through(const MapState& state, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const auto& poses = state.graph.poses;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (cross(p, q, poses[i - 1].p, poses[i].p)) return true;
  return false;
}

std::vector<Stretch> touched_stretches(const MapState& state) {
  std::vector<Stretch> out;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    const auto& landmark = state.graph.landmarks[k];
    if (!landmark.active || landmark.kind != graph::LandmarkKind::Wall) continue;
    if (const auto touched = contact_interval(state, k)) out.push_back({k, WallFrame(landmark), *touched});
  }
  return out;
}

/// For each stretch the one that its head meets, least total cost.
std::vector<std::optional<std::size_t>> join(const MapState& state, const std::vector<Stretch>& stretches,
                                             double join_max) {
  const auto total_cost = [&](const Stretch& a, const Stretch& b) {
    const Meeting at = meeting(a, b, join_max);
    if (at.cost == kNever) return kNever;
    const bool through = walked_through(state, a.frame.point(a.touched.hi), a.frame.point(at.head_s)) ||
                         walked_through(state, b.frame.point(b.touched.lo), b.frame.point(at.tail_s));
    return at.cost + (through ? kCrossingCost : 0.0);
  };
  // One column for each tail, and one of its own for each head that meets nobody.
  const auto n = static_cast<Eigen::Index>(stretches.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(n, 2 * n, kNever);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      if (a != b) cost(a, b) = total_cost(stretches[a], stretches[b]);
    cost(a, n + a) = 1.5 * join_max;
  }
  auto tails = assign(cost);
  for (auto& tail : tails)
    if (tail && *tail >= stretches.size()) tail.reset();
  return tails;
}

}  // namespace

std::vector<FiniteWall> cut_walls(const MapState& state, const MapperConfig::Walls& config) {
  const auto stretches = touched_stretches(state);
  const auto next = join(state, stretches, config.join_max_m);
  const auto straight = [&](std::size_t k) {
    return next[k] && meeting(stretches[k], stretches[*next[k]], config.join_max_m).straight;
  };
  std::vector<bool> continues(stretches.size(), false);  // the stretch before it is the same wall
  for (std::size_t k = 0; k < stretches.size(); ++k)
    if (straight(k)) continues[*next[k]] = true;

  // Chains of stretches become walls; the longest stretch gives the plane.
  std::vector<FiniteWall> walls;
  std::vector<Stretch> planes;
  std::vector<std::size_t> wall_of(stretches.size(), 0), last;
  for (std::size_t start = 0; start < stretches.size(); ++start) {
    if (continues[start]) continue;
    FiniteWall wall;
    std::size_t longest = start, k = start;
    for (;; k = *next[k]) {
      wall.stretches.push_back(stretches[k].landmark);
      wall_of[k] = walls.size();
      if (stretches[k].length() > stretches[longest].length()) longest = k;
      if (!straight(k)) break;
    }
    Stretch plane = stretches[longest];
    plane.touched = {plane.frame.along(stretches[start].frame.point(stretches[start].touched.lo)),
                     plane.frame.along(stretches[k].frame.point(stretches[k].touched.hi))};
    wall.landmark = plane.landmark;
    wall.tail = plane.touched.lo, wall.head = plane.touched.hi;
    walls.push_back(wall), planes.push_back(plane), last.push_back(k);
  }
  for (std::size_t a = 0; a < walls.size(); ++a) {
    if (!next[last[a]]) continue;
    const std::size_t b = wall_of[*next[last[a]]];
    const Meeting at = corner(planes[a], planes[b], config.join_max_m);
    if (at.cost == kNever) continue;
    walls[a].head = at.head_s, walls[a].next = b;
    walls[b].tail = at.tail_s, walls[b].previous = a;
  }
  return walls;
}

std::vector<Room> find_rooms(const MapState& state, const std::vector<FiniteWall>& walls,
                             const MapperConfig::Walls& config) {
  std::vector<Room> rooms;
  std::vector<bool> used(walls.size(), false);
  for (std::size_t start = 0; start < walls.size(); ++start) {
    std::vector<std::size_t> ring;
    for (std::optional<std::size_t> at = start; at && !used[*at]; at = walls[*at].next) {
      used[*at] = true;
      ring.push_back(*at);
    }
    if (ring.size() < 3 || walls[ring.back()].next != start) continue;
    Room room;
    room.height_m = config.height_m;
    for (const std::size_t k : ring) {
      std::uint32_t id = state.landmarks[walls[k].landmark].id;
      for (const std::size_t stretch : walls[k].stretches) id = std::min(id, state.landmarks[stretch].id);
      room.wall_ids.push_back(id);
      room.polygon.push_back(WallFrame(state.graph.landmarks[walls[k].landmark]).point(walls[k].tail).head<2>());
    }
    for (std::size_t k = 0; k < room.polygon.size(); ++k) {
      const auto& p = room.polygon[k];
      const auto& q = room.polygon[(k + 1) % room.polygon.size()];
      room.area_m2 += 0.5 * (p.x() * q.y() - p.y() * q.x());
    }
    if (room.area_m2 <= 0.0) continue;
    room.id = static_cast<std::uint32_t>(rooms.size() + 1);
    rooms.push_back(std::move(room));
  }
  return rooms;
}

}  // namespace kinemap
