// SPDX-License-Identifier: Apache-2.0
// Furniture: each piece is drawn until it stands clear of what is there and leaves room to walk.
#include <functional>

#include "tools/sim/building.hpp"
#include "tools/sim/look_alikes.hpp"

namespace kinemap::sim {

namespace {

constexpr int kTries = 400;
constexpr double kWalkway = FloorSpace::kWalkway;

class Furnisher {
 public:
  Furnisher(Building& building, Scene scene, const Reach& reach, Random& random)
      : b_(building), scene_(scene), reach_(reach), random_(random), space_(building, random) {}

  void run() {
    const auto rooms = static_cast<int>(b_.rooms.size());
    // In three rooms the walls alone fill most of the time that a session has.
    const int tables = random_.integer(2, rooms == 2 ? 4 : 3), big = random_.integer(1, rooms == 3 ? 1 : 2);
    const int small = random_.integer(1, std::min(rooms == 3 ? 2 : 3, tables)),
              chairs = random_.integer(2, rooms == 2 ? 4 : 3);
    // What needs most room goes first. The rooms take turns, so that none stays empty.
    if (scene_ == Scene::ThinWall) keep_partition_free();
    for (int room = 0, done = 0; room < rooms && done == 0; ++room) done = add_look_alikes(room) ? 1 : 0;
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

  bool add_look_alikes(int room) {
    switch (scene_) {
      case Scene::TwinTables:
        return add_twin_tables(b_, space_, room, random_);
      case Scene::ChairRow:
        return add_chair_row(b_, space_, room, random_);
      case Scene::TwinScreens:
        return add_twin_screens(b_, space_, reach_, room, random_);
      default:
        return true;
    }
  }

  /// Both faces of the partition shall be touched along most of their length.
  void keep_partition_free() {
    for (const auto& door : b_.doorways) space_.keep_free({door.centre, door.heading, {0.9, 1.9}});
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
      if (!(freely ? space_.place_freely(room, table.top) : space_.place_at_wall(room, table.top))) continue;
      if (!space_.keeps_free(table.top) || space_.gap_to_furniture(table.top) < kWalkway) continue;
      if (!space_.settle(room, {table.top})) continue;
      table.height = random_.uniform(0.70, 0.78);
      b_.tables.push_back(table);
      return true;
    }
    return false;
  }

  bool add_big_screen(int room) {
    for (int i = 0; i < kTries; ++i) {
      Screen screen;
      screen.room = room;
      screen.big = true;
      screen.width = random_.uniform(1.2, i < kTries / 2 ? 2.0 : 1.4);
      screen.height = std::min(random_.uniform(0.7, 1.2), 0.75 * screen.width);
      // Beside a flush screen there is wall to be touched.
      const auto spot = space_.draw_spot(room, screen.width / 2 + (scene_ == Scene::FlushScreen ? 0.6 : 0.15));
      if (!spot || spot->wall->doorway) continue;
      const bool stand = random_.chance(0.35);
      const bool flush = scene_ == Scene::FlushScreen;
      const double offset = flush   ? random_.uniform(0.015, 0.035)
                            : stand ? random_.uniform(0.35, 0.6)
                                    : random_.uniform(0.04, 0.09);
      const Vec2 front = spot->wall->a + spot->wall->along() * spot->u + spot->wall->inward() * offset;
      screen.heading = heading_of(spot->wall->inward());
      // Both edges must be in reach, without a ladder and without kneeling.
      const double top = std::min(random_.uniform(1.60, 1.85), reach_.highest_m);
      screen.height = std::min(screen.height, top - 0.66);
      screen.centre = lift(front, top - screen.height / 2);
      const Vec2 in = spot->wall->inward();
      const Footprint body{front - in * (offset / 2), screen.heading, {offset / 2, screen.width / 2}};
      const Footprint before{front + in * 0.5, screen.heading, {0.5, screen.width / 2 + 0.25}};
      if (!space_.inside(room, body) || !space_.inside(room, before) || !space_.keeps_free(body) ||
          space_.gap_to_furniture(body) < kWalkway)
        continue;
      if (space_.gap_to_furniture(before) < 0.05) continue;
      if (!space_.settle(room, {body})) continue;
      b_.screens.push_back(screen);
      space_.keep_free(before);
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
      const auto spot = space_.draw_spot(room, 0.3);
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
      if (!space_.inside(room, body) || !space_.inside(room, feet) || !space_.keeps_free(body) ||
          space_.gap_to_furniture(body) < 0.9)
        continue;
      if (space_.gap_to_walls(room, body, at_wall ? spot->wall : nullptr) < 0.6 || space_.gap_to_furniture(feet) < 0.25)
        continue;
      if (space_.gap_to_walls(room, feet, nullptr) < 0.15) continue;
      if (!space_.settle(room, {body})) continue;
      b_.chairs.push_back(chair);
      space_.keep_free(feet);
      return true;
    }
    return false;
  }

  Building& b_;
  Scene scene_;
  Reach reach_;
  Random& random_;
  FloorSpace space_;
};

}  // namespace

void furnish(Building& building, Scene scene, const Reach& reach, Random& random) {
  Furnisher(building, scene, reach, random).run();
}

}  // namespace kinemap::sim
