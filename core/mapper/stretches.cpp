// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/mapper/polygon.hpp"

namespace kinemap {
namespace {

constexpr double kInFront = 0.1;       // m: clearly on the room's side of a wall
constexpr double kBehind = 0.35;       // m: clearly behind it
constexpr double kSamePlane = 0.25;    // m: overlapping stretches so near are one
constexpr double kSameHeading = 0.15;  // rad
constexpr double kShrunk = 0.15;       // m: what drift and a hand on its way may have added to a stretch at either end
constexpr double kPartition = 0.4;     // m: thickest partition whose two faces were touched
constexpr double kBesideDoor = 1.2;    // m: a partition goes on beyond what was touched by a doorway and its frame
constexpr double kSameDoorway = 0.6;   // m: passages so near are through one doorway
constexpr double kFacesApart = 2.2;    // m: its faces may be touched on different sides of the doorway
constexpr double kDoorGap = 1.6;       // m: collinear stretches so near are one wall with a doorway between
constexpr double kStep = 0.4;          // m: from one place to another; people on two sides of a wall are farther apart
constexpr int kEnoughSteps = 10;       // ... and that by many: in a doorway a few seem to lead past the wall
constexpr double kStoreys = 1.5;       // m: apart at least

bool same_side(const Stretch& a, const Stretch& b) {
  return a.frame.normal.dot(b.frame.normal) > std::cos(kSameHeading);
}

/// Along `a`, where `b` was touched.
Interval seen_from(const Stretch& a, const Stretch& b) {
  const double s = a.frame.along(b.tail()), t = a.frame.along(b.head());
  return {std::min(s, t), std::max(s, t)};
}

/// Distance of the middle of `b` from the plane of `a`, > 0 in front.
double offset(const Stretch& a, const Stretch& b) { return a.frame.distance(0.5 * (b.tail() + b.head())); }

/// `b` was touched along the same part of the same plane.
bool is_same_wall(const Stretch& a, const Stretch& b) {
  const Interval i = seen_from(a, b);
  const double shared = std::min(a.touched.hi, i.hi) - std::max(a.touched.lo, i.lo);
  return same_side(a, b) && std::abs(offset(a, b)) < kSamePlane && shared > 0.3 * std::min(a.length(), b.length());
}

void unite(Stretch& a, const Stretch& b) {
  const Stretch& longer = a.length() >= b.length() ? a : b;
  const Interval i = seen_from(longer, &longer == &a ? b : a);
  const Interval touched{std::min(longer.touched.lo, i.lo), std::max(longer.touched.hi, i.hi)};
  const std::size_t landmark = longer.landmark;
  const WallFrame frame = longer.frame;
  a.landmark = landmark, a.frame = frame, a.touched = touched;
  a.landmarks.insert(a.landmarks.end(), b.landmarks.begin(), b.landmarks.end());
  a.poses.insert(a.poses.end(), b.poses.begin(), b.poses.end());
  std::sort(a.poses.begin(), a.poses.end());
}

/// The part of the wall in which walking through it means a doorway: what was touched; the gap to the next stretch in
/// the same plane; and beside it and as far as its other face, where that tells that it is a partition.
Interval solid_part(const Stretch& wall, const std::vector<Stretch>& all) {
  Interval solid{wall.touched.lo + kShrunk, wall.touched.hi - kShrunk};
  for (const Stretch& other : all) {
    if (&other == &wall) continue;
    const Interval i = seen_from(wall, other);
    const double d = offset(wall, other);
    if (same_side(wall, other) && std::abs(d) < kSamePlane) {
      if (i.lo > wall.touched.hi && i.lo < wall.touched.hi + kDoorGap) solid.hi = std::max(solid.hi, i.lo);
      if (i.hi < wall.touched.lo && i.hi > wall.touched.lo - kDoorGap) solid.lo = std::min(solid.lo, i.hi);
    }
    const bool other_face = wall.frame.normal.dot(other.frame.normal) < -std::cos(kSameHeading) && d < 0.1 &&
                            d > -kPartition && i.lo < wall.touched.hi + kFacesApart &&
                            i.hi > wall.touched.lo - kFacesApart;
    if (other_face) {
      solid.lo = std::min({solid.lo, wall.touched.lo - kBesideDoor, i.lo});
      solid.hi = std::max({solid.hi, wall.touched.hi + kBesideDoor, i.hi});
    }
  }
  return solid;
}

class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t find(std::size_t k) {
    while (parent_[k] != k) k = parent_[k];
    return k;
  }
  void unite(std::size_t a, std::size_t b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<std::size_t> parent_;
};

/// Where the wearer went through the same doorway again, the places before it are one room, and those behind it.
void unite_sides(const MapState& state, const WallFrame& wall, const std::vector<Passage>& through,
                 const std::vector<std::size_t>& piece, Sets& sets) {
  const auto sides = [&](const Passage& p) {
    const bool out = wall.distance(state.graph.poses[p.before].p) > 0.0;
    return std::pair(piece[out ? p.before : p.after], piece[out ? p.after : p.before]);
  };
  for (std::size_t k = 1; k < through.size(); ++k) {
    const auto same = std::find_if(through.begin(), through.begin() + static_cast<std::ptrdiff_t>(k),
                                   [&](const Passage& p) { return (p.p - through[k].p).norm() < kSameDoorway; });
    const auto [front, behind] = sides(through[k]);
    const auto [front_before, behind_before] = sides(*same);
    sets.unite(front, front_before), sets.unite(behind, behind_before);
  }
}

/// Places a step from each other are in one room unless something is between them.
void unite_neighbours(const MapState& state, const std::vector<Stretch>& stretches, const std::vector<Interval>& solid,
                      const std::vector<std::size_t>& piece, Sets& sets) {
  const auto& poses = state.graph.poses;
  std::vector<std::size_t> by_x(poses.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return poses[a].p.x() < poses[b].p.x(); });
  const auto wall_between = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    for (std::size_t k = 0; k < stretches.size(); ++k) {
      const WallFrame& wall = stretches[k].frame;
      if (ways_cross(p, q, wall.point(solid[k].lo).head<2>(), wall.point(solid[k].hi).head<2>())) return true;
    }
    return false;
  };
  std::map<std::pair<std::size_t, std::size_t>, int> steps;
  for (std::size_t n = 0; n < by_x.size(); ++n) {
    const Eigen::Vector3d& p = poses[by_x[n]].p;
    for (std::size_t m = n + 1; m < by_x.size() && poses[by_x[m]].p.x() - p.x() < kStep; ++m) {
      const Eigen::Vector3d& q = poses[by_x[m]].p;
      if (std::abs(q.y() - p.y()) > kStep || std::abs(q.z() - p.z()) > kStoreys) continue;
      const std::size_t a = sets.find(piece[by_x[n]]), b = sets.find(piece[by_x[m]]);
      if (a != b && !wall_between(p.head<2>(), q.head<2>())) ++steps[std::minmax(a, b)];
    }
  }
  for (const auto& [pieces, count] : steps)
    if (count >= kEnoughSteps) sets.unite(pieces.first, pieces.second);
}

/// The trajectory falls into pieces where it passes through walls; what was touched from one piece is in one zone.
/// Pieces from which the same wall was touched are one, and so are those on one side of a doorway and those between
/// which there is but a step.
std::vector<std::size_t> find_zones(const MapState& state, std::vector<Stretch>& stretches) {
  std::vector<std::size_t> piece(state.graph.poses.size(), 0);
  std::vector<Interval> solid;
  std::vector<std::vector<Passage>> through;
  for (const Stretch& wall : stretches) {
    solid.push_back(solid_part(wall, stretches));
    through.push_back(passages(state, wall.frame, solid.back().lo, solid.back().hi));
    for (const Passage& passage : through.back())
      if (passage.pose + 1 < piece.size()) piece[passage.pose + 1] = 1;
  }
  for (std::size_t k = 1; k < piece.size(); ++k) piece[k] += piece[k - 1];
  if (piece.empty()) return piece;
  Sets sets(piece.back() + 1);
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    for (const std::size_t pose : stretches[k].poses) sets.unite(piece[pose], piece[stretches[k].poses.front()]);
    unite_sides(state, stretches[k].frame, through[k], piece, sets);
  }
  unite_neighbours(state, stretches, solid, piece, sets);
  for (Stretch& wall : stretches)
    if (!wall.poses.empty()) wall.zone = sets.find(piece[wall.poses.front()]);
  for (std::size_t& zone : piece) zone = sets.find(zone);
  return piece;
}

}  // namespace

std::vector<Passage> passages(const MapState& state, const WallFrame& wall, double lo, double hi) {
  std::vector<Passage> out;
  const auto& poses = state.graph.poses;
  int side = 0;  // 1: clearly in front, -1: clearly behind
  std::size_t since = 0;
  std::optional<std::size_t> through;  // the last key pose before the plane was crossed
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double d = wall.distance(poses[k].p);
    if (k > 0 && (wall.distance(poses[k - 1].p) > 0.0) != (d > 0.0)) through = k - 1;
    const int now = d > kInFront ? 1 : d < -kBehind ? -1 : 0;
    if (now == 0) continue;
    if (side != 0 && now != side && through) {
      const Eigen::Vector3d &a = poses[*through].p, &b = poses[*through + 1].p;
      const double da = wall.distance(a), db = wall.distance(b);
      const Eigen::Vector3d p = a + (b - a) * (da / (da - db));
      const double s = wall.along(p);
      if (s > lo && s < hi) out.push_back({*through, p.head<2>(), since, k});
    }
    side = now, since = k;
  }
  return out;
}

TouchedWalls touched_walls(const MapState& state) {
  std::vector<Stretch> out;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    const auto& landmark = state.graph.landmarks[k];
    if (!landmark.active || landmark.kind != graph::LandmarkKind::Wall) continue;
    const auto touched = contact_interval(state, k);
    if (!touched) continue;
    Stretch stretch{k, WallFrame(landmark), *touched, {k}, {}, 0};
    for (const auto& visit : state.observations) {
      if (visit.landmark != k) continue;
      for (std::size_t c = visit.first_contact; c < visit.first_contact + visit.contacts; ++c)
        stretch.poses.push_back(state.graph.contacts[c].i);
      if (visit.settled)
        for (std::size_t i = visit.settled->first_pose; i <= visit.settled->last_pose; ++i) stretch.poses.push_back(i);
    }
    std::sort(stretch.poses.begin(), stretch.poses.end());
    const auto same = std::find_if(out.begin(), out.end(), [&](const Stretch& s) { return is_same_wall(s, stretch); });
    if (same != out.end())
      unite(*same, stretch);
    else
      out.push_back(std::move(stretch));
  }
  auto zones = find_zones(state, out);
  return {std::move(out), std::move(zones)};
}

}  // namespace kinemap
