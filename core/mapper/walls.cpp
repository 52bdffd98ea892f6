// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/walls.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <queue>

#include "core/assignment.hpp"
#include "core/mapper/joins.hpp"
#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kMaxTrials = 200;  // solutions looked at before rings that are no rooms are broken open
constexpr double kInside = 0.7;          // part of the places from which its walls were touched that a room contains
constexpr double kMinLength = 0.2;       // m
constexpr double kAlongside = 2.0;       // m: who walks so near before a wall walks along it
constexpr double kBody = 0.3;            // m: it goes on so far beyond who does, and clearly past its touched end
constexpr double kMostUntouched = 3.0;   // m that a wall is prolonged by for that
constexpr double kOpenSigma = 2.0;  // m: where nobody touched a wall any farther it may end, or go on through a room

/// For each stretch the one that its head meets.
using Order = std::vector<std::optional<std::size_t>>;

using JoinTable = std::vector<std::vector<Join>>;

struct Solution {
  double cost = 0.0;
  Order next;
  std::vector<std::pair<std::size_t, std::size_t>> forbidden;

  bool operator<(const Solution& other) const { return cost > other.cost; }  // the cheapest comes first in a queue
};

/// The cheapest one-to-one order without the joins that are forbidden.
Solution solve(const JoinTable& joins, std::vector<std::pair<std::size_t, std::size_t>> forbidden) {
  // One column for each tail, and one of its own for each head that meets nobody.
  const auto n = static_cast<Eigen::Index>(joins.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(n, 2 * n, HUGE_VAL);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) cost(a, b) = joins[a][b].cost;
    cost(a, n + a) = Joiner::kOpenCost;
  }
  for (const auto& [a, b] : forbidden) cost(a, b) = HUGE_VAL;
  Solution solution{0.0, assign(cost), std::move(forbidden)};
  for (std::size_t a = 0; a < joins.size(); ++a) {
    solution.cost += cost(a, *solution.next[a]);
    if (*solution.next[a] >= joins.size()) solution.next[a].reset();
  }
  return solution;
}

std::vector<std::vector<std::size_t>> rings_of(const Order& next) {
  std::vector<std::vector<std::size_t>> rings;
  std::vector<bool> seen(next.size(), false);
  for (std::size_t start = 0; start < next.size(); ++start) {
    std::vector<std::size_t> ring;
    for (std::optional<std::size_t> at = start; at && !seen[*at]; at = next[*at]) seen[*at] = true, ring.push_back(*at);
    if (next[ring.empty() ? start : ring.back()] == start && !ring.empty()) rings.push_back(std::move(ring));
  }
  return rings;
}

/// A closed ring is a room when it goes round counter-clockwise, does not cross itself and has the wearer in it.
/// Clockwise and without the wearer it is the outside of something that stands free in a room: a partition, a pillar.
/// The two faces of a partition may cross by drift.
bool is_room_or_island(const MapState& state, const std::vector<Stretch>& walls, const JoinTable& joins,
                       const std::vector<std::size_t>& ring) {
  std::vector<Eigen::Vector2d> polygon;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Join& before = joins[ring[(k + ring.size() - 1) % ring.size()]][ring[k]];
    const Join& after = joins[ring[k]][ring[(k + 1) % ring.size()]];
    const WallFrame& frame = walls[ring[k]].frame;
    if (after.head_s - before.tail_s < kMinLength) return false;
    if (before.kind != Join::Kind::Straight) polygon.push_back(frame.point(before.tail_s).head<2>());
    if (after.kind == Join::Kind::Inferred) polygon.push_back(frame.point(after.head_s).head<2>());
  }
  if (polygon.size() < 3) return false;
  double inside = 0.0, all = 0.0;
  for (const std::size_t k : ring)
    for (const std::size_t pose : walls[k].poses)
      ++all, inside += contains(polygon, state.graph.poses[pose].p.head<2>()) ? 1.0 : 0.0;
  if (area(polygon) > 0.0 && is_simple(polygon) && inside >= kInside * all) return true;
  const bool two_faces = ring.size() == 2;
  return (two_faces || (area(polygon) < 0.0 && is_simple(polygon))) && inside <= (1.0 - kInside) * all;
}

/// The cheapest order of which every ring is a room or an island. Where one is not, each of its joins is forbidden in
/// turn.
Order find_order(const MapState& state, const std::vector<Stretch>& walls, const JoinTable& joins) {
  std::priority_queue<Solution> open;
  open.push(solve(joins, {}));
  for (std::size_t trial = 0;; ++trial) {
    Solution best = open.top();
    open.pop();
    const auto rings = rings_of(best.next);
    const auto wrong = std::find_if(rings.begin(), rings.end(),
                                    [&](const auto& ring) { return !is_room_or_island(state, walls, joins, ring); });
    if (wrong == rings.end()) return best.next;
    if (trial == kMaxTrials) {
      for (const auto& ring : rings)
        if (!is_room_or_island(state, walls, joins, ring)) best.next[ring.back()].reset();
      return best.next;
    }
    for (const std::size_t a : *wrong) {
      auto forbidden = best.forbidden;
      forbidden.emplace_back(a, *best.next[a]);
      open.push(solve(joins, std::move(forbidden)));
    }
  }
}

/// Stretches that continue each other become walls; the longest gives the plane.
struct Chain {
  Stretch plane;
  std::size_t first = 0, last = 0;  ///< stretches at its tail and head
  std::vector<std::size_t> landmarks;
};

std::vector<Chain> chains_of(const std::vector<Stretch>& stretches, const JoinTable& joins, const Order& next) {
  const auto straight = [&](std::size_t k) { return next[k] && joins[k][*next[k]].kind == Join::Kind::Straight; };
  std::vector<bool> continues(stretches.size(), false);
  for (std::size_t k = 0; k < stretches.size(); ++k)
    if (straight(k)) continues[*next[k]] = true;
  std::vector<Chain> chains;
  for (std::size_t start = 0; start < stretches.size(); ++start) {
    if (continues[start]) continue;
    Chain chain{stretches[start], start, start, {}};
    std::size_t longest = start;
    for (std::size_t k = start;; k = *next[k]) {
      chain.landmarks.insert(chain.landmarks.end(), stretches[k].landmarks.begin(), stretches[k].landmarks.end());
      if (stretches[k].length() > stretches[longest].length()) longest = k;
      chain.last = k;
      if (!straight(k)) break;
    }
    chain.plane = stretches[longest];
    chain.plane.touched = {chain.plane.frame.along(stretches[start].tail()),
                           chain.plane.frame.along(stretches[chain.last].head())};
    chains.push_back(std::move(chain));
  }
  return chains;
}

/// Where an end that meets nobody is: where it was touched or, beyond that, where the wearer still walked along the
/// wall and not through it. `sign`: 1 for the head, -1 for the tail.
double open_end(const MapState& state, const TouchedWalls& touched, const Stretch& wall, double sign) {
  const double end = sign > 0.0 ? wall.touched.hi : wall.touched.lo;
  double beyond = 0.0;
  for (std::size_t k = 0; k < state.graph.poses.size(); ++k) {
    if (touched.zone_of_pose[k] != wall.zone) continue;
    const Eigen::Vector3d& p = state.graph.poses[k].p;
    const double before = wall.frame.distance(p), past = sign * (wall.frame.along(p) - end);
    if (before > 0.0 && before < kAlongside && past > kBody && past < kMostUntouched)
      beyond = std::max(beyond, past + kBody);
  }
  const double to = end + sign * beyond;
  const auto crossed = passages(state, wall.frame, std::min(end, to), std::max(end, to));
  return crossed.empty() ? to : end;
}

}  // namespace

std::vector<FiniteWall> cut_walls(const MapState& state, const MapperConfig::Walls& config) {
  const TouchedWalls touched = touched_walls(state);
  const auto& stretches = touched.stretches;
  const Joiner joiner(state, touched, config);
  JoinTable joins(stretches.size(), std::vector<Join>(stretches.size()));
  for (std::size_t a = 0; a < stretches.size(); ++a)
    for (std::size_t b = 0; b < stretches.size(); ++b) joins[a][b] = joiner.join(a, b);
  const Order next = find_order(state, stretches, joins);

  const auto chains = chains_of(stretches, joins, next);
  std::vector<FiniteWall> walls;
  for (const Chain& chain : chains) {
    const Interval& ends = chain.plane.touched;
    walls.push_back({chain.plane.landmark,
                     chain.landmarks,
                     {ends.lo, EndKind::Open, {}, kOpenSigma},
                     {ends.hi, EndKind::Open, {}, kOpenSigma}});
  }
  for (std::size_t a = 0; a < chains.size(); ++a) {
    const auto meets = next[chains[a].last];
    if (!meets) continue;
    const auto b = static_cast<std::size_t>(
        std::find_if(chains.begin(), chains.end(), [&](const Chain& c) { return c.first == *meets; }) - chains.begin());
    Join at = joins[chains[a].last][*meets];
    EndKind kind = EndKind::Corner;
    if (at.kind == Join::Kind::Corner) {
      at = joiner.corner(chains[a].plane, chains[b].plane);
    } else {
      kind = EndKind::Inferred;
      at.head_s = chains[a].plane.frame.along(stretches[chains[a].last].frame.point(at.head_s));
      at.tail_s = chains[b].plane.frame.along(stretches[chains[b].first].frame.point(at.tail_s));
    }
    if (at.kind == Join::Kind::None) continue;
    walls[a].head = {at.head_s, kind, b, at.sigma_m};
    walls[b].tail = {at.tail_s, kind, a, at.sigma_m};
  }
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const Stretch& plane = chains[k].plane;
    if (walls[k].tail.kind == EndKind::Open) walls[k].tail.s = open_end(state, touched, plane, -1.0);
    if (walls[k].head.kind == EndKind::Open) walls[k].head.s = open_end(state, touched, plane, 1.0);
  }
  return walls;
}

}  // namespace kinemap
