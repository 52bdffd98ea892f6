// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/walls.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/floor.hpp"

namespace kinemap {
namespace {

constexpr double kFarthestFace = 0.5;    // m: both faces of a wall as thick as this share their doorway
constexpr double kParallel = 0.7;        // |cos| of the angle between a wall's normal and a way through it
constexpr double kSameCorner = 0.02;     // m: faces whose ends are so near meet there
constexpr double kSharpestCorner = 2.4;  // rad: beyond, the backs would meet far away
constexpr double kSliver = 0.05;         // m: shorter ends between a doorway and a corner are not drawn

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// From where to where (m from `wall.a`) doorways open it, ascending, not overlapping.
std::vector<std::array<double, 2>> openings(const WallStretch& wall, const std::vector<Doorway>& doorways) {
  std::vector<std::array<double, 2>> open;
  const Eigen::Vector2d along = wall.along(), normal = wall.normal();
  for (const Doorway& doorway : doorways) {
    const Eigen::Vector2d way(std::cos(doorway.heading_rad), std::sin(doorway.heading_rad));
    const double s = along.dot(doorway.position - wall.a), half = kDoorwayWidth / 2;
    if (std::abs(normal.dot(doorway.position - wall.a)) > kFarthestFace || std::abs(way.dot(normal)) < kParallel)
      continue;
    if (s > -half && s < wall.length() + half)
      open.push_back({std::max(0.0, s - half), std::min(wall.length(), s + half)});
  }
  std::sort(open.begin(), open.end());
  std::vector<std::array<double, 2>> merged;
  for (const auto& next : open) {
    if (!merged.empty() && next[0] <= merged.back()[1] + kSliver)
      merged.back()[1] = std::max(merged.back()[1], next[1]);
    else
      merged.push_back(next);
  }
  return merged;
}

void add_cut(const WallStretch& wall, const std::vector<Doorway>& doorways, std::vector<WallStretch>& stretches) {
  const auto add = [&](double from, double to, bool open) {
    if (to - from < kSliver) return;
    WallStretch part = wall;
    part.open = open;
    part.a = wall.a + from * wall.along();
    part.b = wall.a + to * wall.along();
    stretches.push_back(part);
  };
  double at = 0.0;
  for (const auto& [from, to] : openings(wall, doorways)) {
    add(at, from, false);
    add(from, to, true);
    at = to;
  }
  add(at, wall.length(), false);
}

/// Lets the backs of walls meet where their faces do.
void mitre(std::vector<WallStretch>& stretches) {
  std::vector<WallStretch*> by_begin;
  for (WallStretch& wall : stretches) by_begin.push_back(&wall);
  const auto x_of = [](const WallStretch* wall) { return wall->a.x(); };
  std::ranges::stable_sort(by_begin, {}, x_of);
  for (WallStretch& first : stretches)
    for (auto at = std::ranges::lower_bound(by_begin, first.b.x() - kSameCorner, {}, x_of); at != by_begin.end();
         ++at) {
      WallStretch& second = **at;
      if (second.a.x() > first.b.x() + kSameCorner) break;
      if (&first == &second || (first.wall_id == 0) != (second.wall_id == 0)) continue;
      if ((first.b - second.a).norm() > kSameCorner) continue;
      const double turn = std::atan2(cross(first.along(), second.along()), first.along().dot(second.along()));
      if (std::abs(turn) < kSharpestCorner) first.mitre_b = second.mitre_a = std::tan(turn / 2);
    }
}

}  // namespace

std::array<Eigen::Vector2d, 4> WallStretch::outline(double thickness) const {
  const Eigen::Vector2d back = -thickness * normal();
  return {a, a + back - mitre_a * thickness * along(), b + back + mitre_b * thickness * along(), b};
}

std::array<Eigen::Vector2d, 2> ends_of(const MapObject& upright) {
  const Eigen::Vector2d normal = upright.plane->normal.head<2>();
  const auto before = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return cross(p.head<2>(), normal) < cross(q.head<2>(), normal);
  };
  const auto [a, b] = std::minmax_element(upright.corners->begin(), upright.corners->end(), before);
  return {a->head<2>(), b->head<2>()};
}

std::vector<WallStretch> wall_stretches(const MapSnapshot& map) {
  std::vector<WallStretch> stretches;
  const std::vector<double> floors = floor_heights(map);
  for (std::size_t i = 0; i < map.rooms.size(); ++i)
    for (const std::size_t side : map.rooms[i].inferred_sides) {
      const auto& polygon = map.rooms[i].polygon;
      if (side >= polygon.size()) continue;
      WallStretch wall;
      wall.a = polygon[side];
      wall.b = polygon[(side + 1) % polygon.size()];
      wall.bottom_z = floors[i];
      wall.top_z = wall.bottom_z + map.rooms[i].height_m;
      add_cut(wall, map.doorways, stretches);
    }
  for (const MapObject& object : map.objects) {
    if (object.type != ObjectType::Wall || !object.plane || !object.corners) continue;
    WallStretch wall;
    wall.wall_id = object.id;
    wall.a = ends_of(object)[0];
    wall.b = ends_of(object)[1];
    wall.bottom_z = wall.top_z = object.corners->front().z();
    for (const Eigen::Vector3d& corner : *object.corners) {
      wall.bottom_z = std::min(wall.bottom_z, corner.z());
      wall.top_z = std::max(wall.top_z, corner.z());
    }
    add_cut(wall, map.doorways, stretches);
  }
  mitre(stretches);
  return stretches;
}

std::span<const WallStretch> stretches_of(std::span<const WallStretch> stretches, std::uint32_t wall_id) {
  // Not equal_range, whose result clang 14 cannot compile.
  return {std::ranges::lower_bound(stretches, wall_id, {}, &WallStretch::wall_id),
          std::ranges::upper_bound(stretches, wall_id, {}, &WallStretch::wall_id)};
}

}  // namespace kinemap
