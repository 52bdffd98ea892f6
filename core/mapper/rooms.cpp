// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/rooms.hpp"

#include <algorithm>
#include <cmath>

#include "core/mapper/polygon.hpp"
#include "core/mapper/stretches.hpp"

namespace kinemap {
namespace {

constexpr double kSameDoorway = 0.6;  // m: passages so near are one doorway
constexpr double kLeastArea = 0.5;    // m²: nobody was in less; the faces of a thin partition may seem to cross

/// A wall has the id that the first of its stretches had.
std::uint32_t id_of(const MapState& state, const FiniteWall& wall) {
  std::uint32_t id = state.landmarks[wall.landmark].id;
  for (const std::size_t stretch : wall.stretches) id = std::min(id, state.landmarks[stretch].id);
  return id;
}

Room room_of(const MapState& state, const std::vector<FiniteWall>& walls, const std::vector<std::size_t>& ring) {
  Room room;
  for (const std::size_t k : ring) {
    const WallFrame frame(state.graph.landmarks[walls[k].landmark]);
    room.wall_ids.push_back(id_of(state, walls[k]));
    room.polygon.emplace_back(frame.point(walls[k].tail.s).head<2>());
    if (walls[k].head.kind != EndKind::Inferred) continue;
    room.inferred_sides.push_back(room.polygon.size());  // begins at the head, which comes next
    room.polygon.emplace_back(frame.point(walls[k].head.s).head<2>());
  }
  room.area_m2 = area(room.polygon);
  return room;
}

/// The room that contains `p`.
std::optional<std::uint32_t> room_at(const std::vector<Room>& rooms, const Eigen::Vector3d& p) {
  for (const Room& room : rooms)
    if (contains(room.polygon, p.head<2>())) return room.id;
  return std::nullopt;
}

void add_room(Doorway& doorway, std::optional<std::uint32_t> room) {
  auto& ids = doorway.room_ids;
  if (room && std::find(ids.begin(), ids.end(), *room) == ids.end()) ids.push_back(*room);
  std::sort(ids.begin(), ids.end());
}

}  // namespace

std::vector<Room> find_rooms(const MapState& state, const std::vector<FiniteWall>& walls,
                             const MapperConfig::Walls& config) {
  std::vector<Room> rooms;
  std::vector<bool> used(walls.size(), false);
  for (std::size_t start = 0; start < walls.size(); ++start) {
    std::vector<std::size_t> ring;
    for (std::optional<std::size_t> at = start; at && !used[*at]; at = walls[*at].head.neighbour) {
      used[*at] = true;
      ring.push_back(*at);
    }
    if (ring.empty() || walls[ring.back()].head.neighbour != start) continue;
    Room room = room_of(state, walls, ring);
    if (room.polygon.size() < 3 || room.area_m2 < kLeastArea) continue;
    room.height_m = config.height_m;
    room.id = static_cast<std::uint32_t>(rooms.size() + 1);
    rooms.push_back(std::move(room));
  }
  return rooms;
}

std::vector<Doorway> find_doorways(const MapState& state, const std::vector<FiniteWall>& walls,
                                   const std::vector<Room>& rooms) {
  std::vector<Doorway> doorways;
  std::vector<int> count;
  for (const FiniteWall& wall : walls) {
    const WallFrame frame(state.graph.landmarks[wall.landmark]);
    for (const Passage& passage : passages(state, frame, wall.tail.s, wall.head.s)) {
      auto at = std::find_if(doorways.begin(), doorways.end(), [&](const Doorway& d) {
        const double parallel = std::cos(d.heading_rad) * frame.normal.x() + std::sin(d.heading_rad) * frame.normal.y();
        return (d.position - passage.p).norm() < kSameDoorway && std::abs(parallel) > 0.8;
      });
      if (at == doorways.end()) {
        at = doorways.insert(at, {passage.p, std::atan2(frame.normal.y(), frame.normal.x()), {}});
        count.push_back(0);
      }
      const int n = ++count[static_cast<std::size_t>(at - doorways.begin())];
      at->position += (passage.p - at->position) / n;
      for (const std::size_t pose : {passage.before, passage.after})
        add_room(*at, room_at(rooms, state.graph.poses[pose].p));
    }
  }
  return doorways;
}

}  // namespace kinemap
