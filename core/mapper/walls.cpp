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

constexpr double kMinAngle = 0.35;   // rad: flatter intersections are no corners
constexpr double kShortening = 3.0;  // a wall that was touched beyond the corner speaks louder against it than a gap
constexpr double kMinLength = 0.2;   // m

struct Piece {
  WallFrame frame;
  Interval touched;
};

struct Corner {
  double head_s = 0.0;  ///< on the wall that ends there
  double tail_s = 0.0;  ///< on the wall that begins there
  double cost = std::numeric_limits<double>::infinity();
};

/// The corner where the head of `a` meets the tail of `b`.
Corner corner(const Piece& a, const Piece& b, double join_max) {
  Eigen::Matrix2d m;
  m.col(0) = a.frame.axis.head<2>();
  m.col(1) = -b.frame.axis.head<2>();
  if (std::abs(m.determinant()) < std::sin(kMinAngle)) return {};
  const Eigen::Vector2d s = m.inverse() * (b.frame.origin - a.frame.origin).head<2>();
  const double longer_a = s[0] - a.touched.hi, longer_b = b.touched.lo - s[1];
  const auto cost = [](double longer) { return longer >= 0.0 ? longer : -kShortening * longer; };
  if (longer_a > join_max || longer_b > join_max || s[0] < a.touched.lo + kMinLength ||
      s[1] > b.touched.hi - kMinLength)
    return {};
  return {s[0], s[1], cost(longer_a) + cost(longer_b)};
}

}  // namespace

std::vector<FiniteWall> cut_walls(const MapState& state, const MapperConfig::Walls& config) {
  std::vector<FiniteWall> walls;
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    const auto& landmark = state.graph.landmarks[k];
    if (!landmark.active || landmark.kind != graph::LandmarkKind::Wall) continue;
    const auto touched = contact_interval(state, k);
    if (!touched) continue;
    pieces.push_back({WallFrame(landmark), *touched});
    walls.push_back({k, touched->lo, touched->hi, {}, {}});
  }
  // One column for each tail, and one of its own for each head that meets nobody.
  const auto n = static_cast<Eigen::Index>(walls.size());
  constexpr double kNever = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(n, 2 * n, kNever);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      if (a != b) cost(a, b) = corner(pieces[a], pieces[b], config.join_max_m).cost;
    cost(a, n + a) = 2.0 * config.join_max_m;
  }
  const auto tails = assign(cost);
  for (std::size_t a = 0; a < walls.size(); ++a) {
    if (!tails[a] || *tails[a] >= walls.size()) continue;
    const std::size_t b = *tails[a];
    const Corner at = corner(pieces[a], pieces[b], config.join_max_m);
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
      room.wall_ids.push_back(state.landmarks[walls[k].landmark].id);
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
