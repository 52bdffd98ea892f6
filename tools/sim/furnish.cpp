// SPDX-License-Identifier: Apache-2.0
// Furniture: each piece is drawn until it stands clear of what is there and leaves room to walk.
#include <functional>

#include "tools/sim/building.hpp"

namespace kinemap::sim {

namespace {

constexpr int kTries = 400;
constexpr double kWalkway = 0.85;  ///< free breadth around what one walks round, m

/// A spot along a wall: `u` metres from its start.
struct WallSpot {
  const WallFace* wall = nullptr;
  double u = 0.0;
};

class Furnisher {
 public:
  Furnisher(Building& building, const Reach& reach, Random& random) : b_(building), reach_(reach), random_(random) {
    for (const auto& door : b_.doorways) keep_free_.push_back({door.centre, door.heading, {1.0, 0.75}});
  }

  void run() {
    const auto rooms = static_cast<int>(b_.rooms.size());
    // In three rooms the walls alone fill most of the time that a session has.
    const int tables = random_.integer(2, rooms == 2 ? 4 : 3), big = random_.integer(1, rooms == 3 ? 1 : 2);
    const int small = random_.integer(1, std::min(rooms == 3 ? 2 : 3, tables)),
              chairs = random_.integer(2, rooms == 2 ? 4 : 3);
    // What needs most room goes first. The rooms take turns, so that none stays empty.
    for (int i = 0; i < tables; ++i) try_rooms(i, [this](int room) { return add_table(room); });
    for (int i = 0; i < big; ++i) try_rooms(i + 1, [this](int room) { return add_big_screen(room); });
    for (int i = 0; i < small; ++i) add_monitor();
    for (int i = 0; i < chairs; ++i) try_rooms(i, [this](int room) { return add_chair(room); });
  }

 private:
  void try_rooms(int turn, const std::function<bool(int)>& add) {
    const auto rooms = static_cast<int>(b_.rooms.size());
    for (int i = 0; i < rooms; ++i) {
      if (add((turn + i) % rooms)) return;
    }
  }

  /// Inside the room with every corner, and `margin` away from its walls except those that it touches (`touching`).
  [[nodiscard]] bool inside(int room, const Footprint& f) const {
    for (const auto& corner : f.grown(-0.02).corners()) {
      if (!b_.rooms[static_cast<std::size_t>(room)].contains(corner)) return false;
    }
    for (const auto& wall : b_.walls) {  // a reflex corner of an L-shaped room may reach into a long piece
      if (wall.room == room && f.grown(-0.02).distance(wall.a) == 0.0) return false;
    }
    return true;
  }
  [[nodiscard]] double gap_to_furniture(const Footprint& f) const {
    double least = 1e9;
    for (const auto& other : b_.obstacles) least = std::min(least, gap(f, other));
    return least;
  }
  [[nodiscard]] bool keeps_free(const Footprint& f) const {
    for (const auto& zone : keep_free_) {
      if (gap(f, zone) <= 0.0) return false;
    }
    return true;
  }
  [[nodiscard]] double gap_to_walls(int room, const Footprint& f, const WallFace* except) const {
    double least = 1e9;
    for (const auto& wall : b_.walls) {
      if (wall.room != room || &wall == except) continue;
      const Footprint line{(wall.a + wall.b) / 2, heading_of(wall.along()), {wall.length() / 2, 1e-4}};
      least = std::min(least, gap(f, line));
    }
    return least;
  }

  std::optional<WallSpot> draw_spot(int room, double half_length) {
    std::vector<const WallFace*> faces;
    for (const auto& wall : b_.walls) {
      if (wall.room == room && wall.length() > 2 * half_length + 0.3) faces.push_back(&wall);
    }
    if (faces.empty()) return std::nullopt;
    const auto* wall = faces[static_cast<std::size_t>(random_.integer(0, static_cast<int>(faces.size()) - 1))];
    return WallSpot{wall, random_.uniform(half_length, wall->length() - half_length)};
  }

  bool add_table(int room) {
    Table table;
    table.room = room;
    const bool free_standing = random_.chance(0.55);
    for (int i = 0; i < kTries; ++i) {
      table.top.half = Vec2(random_.uniform(1.0, i < kTries / 2 ? 2.0 : 1.3), random_.uniform(0.6, 1.0)) / 2;
      if (table.top.half.y() > 0.7 * table.top.half.x()) table.top.half.y() = 0.7 * table.top.half.x();
      table.top.half.y() = std::max(table.top.half.y(), 0.3);
      const bool freely = free_standing == (i < kTries / 2);  // the other way when there is no room
      if (!(freely ? place_freely(table) : place_at_wall(table))) continue;
      if (!keeps_free(table.top) || gap_to_furniture(table.top) < kWalkway) continue;
      table.height = random_.uniform(0.70, 0.78);
      b_.tables.push_back(table);
      b_.obstacles.push_back(table.top);
      return true;
    }
    return false;
  }

  bool place_at_wall(Table& table) {
    const auto spot = draw_spot(table.room, table.top.half.x());
    if (!spot) return false;
    double u = spot->u;
    const bool corner = random_.chance(0.2);
    if (corner) u = random_.chance(0.5) ? table.top.half.x() + 0.01 : spot->wall->length() - table.top.half.x() - 0.01;
    table.top.heading = heading_of(spot->wall->along());
    table.top.centre = spot->wall->a + spot->wall->along() * u + spot->wall->inward() * (table.top.half.y() + 0.01);
    if (!inside(table.room, table.top)) return false;
    return corner || gap_to_walls(table.room, table.top, spot->wall) > kWalkway;
  }

  bool place_freely(Table& table) {
    const auto& polygon = b_.rooms[static_cast<std::size_t>(table.room)].polygon;
    Vec2 low = polygon[0], high = polygon[0];
    for (const auto& p : polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
    table.top.centre = {random_.uniform(low.x(), high.x()), random_.uniform(low.y(), high.y())};
    table.top.heading = random_.chance(0.5) ? 0.0 : kPi / 2;
    if (random_.chance(0.2)) table.top.heading += random_.uniform(-0.4, 0.4);
    return inside(table.room, table.top) && gap_to_walls(table.room, table.top, nullptr) > kWalkway + 0.1;
  }

  bool add_big_screen(int room) {
    for (int i = 0; i < kTries; ++i) {
      Screen screen;
      screen.room = room;
      screen.big = true;
      screen.width = random_.uniform(1.2, i < kTries / 2 ? 2.0 : 1.4);
      screen.height = std::min(random_.uniform(0.7, 1.2), 0.75 * screen.width);
      const auto spot = draw_spot(room, screen.width / 2 + 0.15);
      if (!spot || spot->wall->doorway) continue;
      const bool stand = random_.chance(0.35);
      const double offset = stand ? random_.uniform(0.35, 0.6) : random_.uniform(0.04, 0.09);
      const Vec2 front = spot->wall->a + spot->wall->along() * spot->u + spot->wall->inward() * offset;
      screen.heading = heading_of(spot->wall->inward());
      // Both edges must be in reach, without a ladder and without kneeling.
      const double top = std::min(random_.uniform(1.60, 1.85), reach_.highest_m);
      screen.height = std::min(screen.height, top - 0.66);
      screen.centre = lift(front, top - screen.height / 2);
      const Vec2 in = spot->wall->inward();
      const Footprint body{front - in * (offset / 2), screen.heading, {offset / 2, screen.width / 2}};
      const Footprint before{front + in * 0.5, screen.heading, {0.5, screen.width / 2 + 0.25}};
      if (!inside(room, body) || !inside(room, before) || !keeps_free(body) || gap_to_furniture(body) < kWalkway)
        continue;
      if (gap_to_furniture(before) < 0.05) continue;
      b_.screens.push_back(screen);
      b_.obstacles.push_back(body);
      keep_free_.push_back(before);
      return true;
    }
    return false;
  }

  /// On a table, facing one of its long sides from which one can reach it.
  void add_monitor() {
    std::vector<int> free;
    for (std::size_t i = 0; i < b_.tables.size(); ++i) {
      if (!b_.tables[i].carries_screen) free.push_back(static_cast<int>(i));
    }
    while (!free.empty()) {
      const auto pick = static_cast<std::size_t>(random_.integer(0, static_cast<int>(free.size()) - 1));
      if (put_on_table(free[pick])) return;
      free.erase(free.begin() + static_cast<long>(pick));
    }
  }

  bool put_on_table(int index) {
    auto& table = b_.tables[static_cast<std::size_t>(index)];
    Screen screen;
    screen.room = table.room;
    screen.table = index;
    screen.width = random_.uniform(0.45, 0.65);
    screen.height = random_.uniform(0.28, std::min(0.40, 0.72 * screen.width));
    const double side = random_.sign();
    const Vec2 along = direction(table.top.heading), out = left_of(along) * side;
    const double depth = std::min(
        {random_.uniform(0.28, 0.42), 2 * table.top.half.y() - 0.15, reach_.over_table_m});  // behind the table's edge
    const double room_along = table.top.half.x() - screen.width / 2 - 0.05;
    const Vec2 at =
        table.top.centre + out * (table.top.half.y() - depth) + along * random_.uniform(-room_along, room_along);
    if (b_.clearance(at + out * (depth + 0.35)) < 0.30) return false;
    screen.centre = lift(at, table.height + random_.uniform(0.08, 0.13) + screen.height / 2);
    screen.heading = heading_of(out);
    table.carries_screen = true;
    b_.screens.push_back(screen);
    return true;
  }

  bool add_chair(int room) {
    for (int i = 0; i < kTries; ++i) {
      const auto spot = draw_spot(room, 0.3);
      if (!spot) return false;
      Chair chair;
      chair.room = room;
      const bool at_wall = random_.chance(0.35);
      const double off = at_wall ? random_.uniform(0.27, 0.35) : random_.uniform(1.1, 2.5);
      chair.seat = spot->wall->a + spot->wall->along() * spot->u + spot->wall->inward() * off;
      chair.heading = heading_of(spot->wall->inward());
      if (at_wall)
        chair.heading += random_.uniform(-0.15, 0.15);
      else
        chair.heading += random_.uniform(-kPi, kPi);
      chair.height = random_.uniform(0.42, 0.50);
      const Footprint body{chair.seat, chair.heading, {0.22, 0.22}};
      const Footprint feet{chair.seat + direction(chair.heading) * 0.55, chair.heading, {0.3, 0.25}};
      if (!inside(room, body) || !inside(room, feet) || !keeps_free(body) || gap_to_furniture(body) < 0.9) continue;
      if (gap_to_walls(room, body, at_wall ? spot->wall : nullptr) < 0.6 || gap_to_furniture(feet) < 0.25) continue;
      if (gap_to_walls(room, feet, nullptr) < 0.15) continue;
      b_.chairs.push_back(chair);
      b_.obstacles.push_back(body);
      keep_free_.push_back(feet);
      return true;
    }
    return false;
  }

  Building& b_;
  Reach reach_;
  Random& random_;
  std::vector<Footprint> keep_free_;
};

}  // namespace

void furnish(Building& building, const Reach& reach, Random& random) { Furnisher(building, reach, random).run(); }

}  // namespace kinemap::sim
