// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/look_alikes.hpp"

#include <functional>

namespace kinemap::sim {

namespace {

constexpr int kTries = 800;

/// Finds a place for a group: along a wall or free.
bool place(FloorSpace& space, int room, Footprint& group, double free_chance, Random& random) {
  const bool freely = random.chance(free_chance);
  if (!(freely ? space.place_freely(room, group) : space.place_at_wall(room, group))) return false;
  return space.keeps_free(group) && space.gap_to_furniture(group) >= FloorSpace::kWalkway;
}

bool try_often(const std::function<bool(int)>& once) {
  for (int i = 0; i < kTries; ++i) {
    if (once(i)) return true;
  }
  return false;
}

}  // namespace

bool add_twin_tables(Building& building, FloorSpace& space, int room, Random& random) {
  return try_often([&](int i) {
    Table table;
    table.room = room;
    table.height = random.uniform(0.70, 0.78);
    table.top.half = Vec2(random.uniform(1.0, i < kTries / 2 ? 1.4 : 1.1), random.uniform(0.6, 0.8)) / 2;
    const double gap = random.chance(0.65) ? random.uniform(0.10, 0.30) : random.uniform(0.85, 1.05);
    Footprint group{{0, 0}, 0.0, {2 * table.top.half.x() + gap / 2, table.top.half.y()}};
    if (!place(space, room, group, 0.5, random)) return false;
    table.top.heading = group.heading;
    Table twin = table;
    const Vec2 aside = direction(group.heading) * (table.top.half.x() + gap / 2);
    table.top.centre = group.centre - aside;
    twin.top.centre = group.centre + aside;
    if (!space.settle(room, {table.top, twin.top})) return false;
    building.tables.push_back(table);
    building.tables.push_back(twin);
    return true;
  });
}

bool add_chair_row(Building& building, FloorSpace& space, int room, Random& random) {
  return try_often([&](int i) {
    const int count = i < kTries / 2 ? random.integer(3, 4) : 3;
    const double spacing = random.uniform(0.6, 0.7), half = 0.5 * spacing * (count - 1);
    const auto spot = space.draw_spot(room, half + 0.35);
    if (!spot) return false;
    const Vec2 in = spot->wall->inward(), along = spot->wall->along();
    const Vec2 middle = spot->wall->a + along * spot->u + in * random.uniform(0.27, 0.35);
    const Footprint row{middle, heading_of(along), {half + 0.22, 0.22}};
    const Footprint feet{middle + in * 0.6, heading_of(along), {half + 0.25, 0.38}};
    if (!space.inside(room, row) || !space.inside(room, feet) || !space.keeps_free(row)) return false;
    if (space.gap_to_furniture(row) < 0.9 || space.gap_to_furniture(feet) < 0.3) return false;
    if (space.gap_to_walls(room, feet, nullptr) < 0.15) return false;
    Chair chair;
    chair.room = room;
    chair.height = random.uniform(0.42, 0.50);
    std::vector<Chair> chairs;
    std::vector<Footprint> bodies;
    for (int k = 0; k < count; ++k) {
      chair.seat = middle + along * (spacing * k - half);
      chair.heading = heading_of(in) + random.normal(0.03);
      chairs.push_back(chair);
      bodies.push_back({chair.seat, chair.heading, {0.22, 0.22}});
    }
    if (!space.settle(room, bodies)) return false;
    building.chairs.insert(building.chairs.end(), chairs.begin(), chairs.end());
    space.keep_free(feet);
    return true;
  });
}

bool add_twin_screens(Building& building, FloorSpace& space, const Reach& reach, int room, Random& random) {
  return try_often([&](int) {
    Table table;
    table.room = room;
    table.carries_screen = true;
    table.height = random.uniform(0.70, 0.78);
    table.top.half = Vec2(random.uniform(1.4, 1.8), random.uniform(0.6, 0.8)) / 2;
    if (!place(space, room, table.top, 0.4, random)) return false;
    Screen screen;
    screen.room = room;
    screen.table = static_cast<int>(building.tables.size());
    screen.width = random.uniform(0.45, std::min(0.60, table.top.half.x() - 0.12));
    screen.height = random.uniform(0.28, 0.36);
    const double depth = std::min({random.uniform(0.28, 0.42), 2 * table.top.half.y() - 0.15, reach.over_table_m});
    const double apart = screen.width + random.uniform(0.03, 0.15);
    // At a wall there is only one side from which one can reach them.
    const Vec2 along = direction(table.top.heading);
    for (const double side : {1.0, -1.0}) {
      const Vec2 out = left_of(along) * side;
      const Vec2 middle = table.top.centre + out * (table.top.half.y() - depth);
      if (building.clearance(table.top.centre + out * (table.top.half.y() + 0.5)) < 0.35) continue;
      if (!space.settle(room, {table.top})) return false;
      screen.heading = heading_of(out);
      for (const double k : {-0.5, 0.5}) {
        screen.centre = lift(middle + along * (k * apart), table.height + 0.1 + screen.height / 2);
        building.screens.push_back(screen);
      }
      building.tables.push_back(table);
      return true;
    }
    return false;
  });
}

}  // namespace kinemap::sim
