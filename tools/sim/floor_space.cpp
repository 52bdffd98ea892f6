// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/floor_space.hpp"

namespace kinemap::sim {

FloorSpace::FloorSpace(Building& building, Random& random) : b_(building), random_(random) {
  for (const auto& door : b_.doorways) keep_free({door.centre, door.heading, {1.0, 0.75}});
}

bool FloorSpace::keeps_free(const Footprint& f) const {
  return std::none_of(keep_free_.begin(), keep_free_.end(), [&](const Footprint& zone) { return gap(f, zone) <= 0.0; });
}

bool FloorSpace::inside(int room, const Footprint& f) const {
  for (const auto& corner : f.grown(-0.02).corners()) {
    if (!b_.rooms[static_cast<std::size_t>(room)].contains(corner)) return false;
  }
  for (const auto& wall : b_.walls) {  // a reflex corner of an L-shaped room may reach into a long piece
    if (wall.room == room && f.grown(-0.02).distance(wall.a) == 0.0) return false;
  }
  return true;
}

double FloorSpace::gap_to_furniture(const Footprint& f) const {
  double least = 1e9;
  for (const auto& other : b_.obstacles) least = std::min(least, gap(f, other));
  return least;
}

double FloorSpace::gap_to_walls(int room, const Footprint& f, const WallFace* except) const {
  double least = 1e9;
  for (const auto& wall : b_.walls) {
    if (wall.room != room || &wall == except) continue;
    const Footprint line{(wall.a + wall.b) / 2, heading_of(wall.along()), {wall.length() / 2, 1e-4}};
    least = std::min(least, gap(f, line));
  }
  return least;
}

bool FloorSpace::settle(int room, const std::vector<Footprint>& pieces) {
  const auto touchable = [&] {
    return std::count_if(b_.walls.begin(), b_.walls.end(),
                         [&](const WallFace& wall) { return wall.room == room && !free_stretches(b_, wall).empty(); });
  };
  const auto before = touchable();
  b_.obstacles.insert(b_.obstacles.end(), pieces.begin(), pieces.end());
  if (touchable() == before) return true;
  b_.obstacles.resize(b_.obstacles.size() - pieces.size());
  return false;
}

std::optional<WallSpot> FloorSpace::draw_spot(int room, double half_length) {
  std::vector<const WallFace*> faces;
  for (const auto& wall : b_.walls) {
    if (wall.room == room && wall.length() > 2 * half_length + 0.3) faces.push_back(&wall);
  }
  if (faces.empty()) return std::nullopt;
  const auto* wall = faces[static_cast<std::size_t>(random_.integer(0, static_cast<int>(faces.size()) - 1))];
  return WallSpot{wall, random_.uniform(half_length, wall->length() - half_length)};
}

bool FloorSpace::place_at_wall(int room, Footprint& f) {
  const auto spot = draw_spot(room, f.half.x());
  if (!spot) return false;
  double u = spot->u;
  const bool corner = random_.chance(0.2);
  if (corner) u = random_.chance(0.5) ? f.half.x() + 0.01 : spot->wall->length() - f.half.x() - 0.01;
  f.heading = heading_of(spot->wall->along());
  f.centre = spot->wall->a + spot->wall->along() * u + spot->wall->inward() * (f.half.y() + 0.01);
  if (!inside(room, f)) return false;
  return corner || gap_to_walls(room, f, spot->wall) > kWalkway;
}

bool FloorSpace::place_freely(int room, Footprint& f) {
  const auto& polygon = b_.rooms[static_cast<std::size_t>(room)].polygon;
  Vec2 low = polygon[0], high = polygon[0];
  for (const auto& p : polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
  f.centre = {random_.uniform(low.x(), high.x()), random_.uniform(low.y(), high.y())};
  f.heading = random_.chance(0.5) ? 0.0 : kPi / 2;
  if (random_.chance(0.2)) f.heading += random_.uniform(-0.4, 0.4);
  return inside(room, f) && gap_to_walls(room, f, nullptr) > kWalkway + 0.1;
}

}  // namespace kinemap::sim
