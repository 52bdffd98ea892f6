// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/building.hpp"

#include "tools/sim/scene.hpp"

namespace kinemap::sim {

namespace {

constexpr double kShortestStretch = 0.8;
constexpr double kUsualPartition = 0.12;  ///< between the two faces of a wall that parts two rooms, m

/// A shell before it is joined to others: a rectangle, perhaps with one of its upper corners (large y) missing or with
/// its upper side oblique.
struct ShellPlan {
  double x0 = 0.0, y0 = 0.0, width = 0.0, depth = 0.0;
  double notch_width = 0.0, notch_depth = 0.0;  ///< 0: plain rectangle
  bool notch_right = false;
  double slope = 0.0;  ///< of the upper side: rad, rising from the notch's side

  [[nodiscard]] std::vector<Vec2> polygon() const {
    const double x1 = x0 + width, y1 = y0 + depth;
    if (slope > 0.0) return {{x0, y0}, {x1, y0}, {x1, side_top(true)}, {x0, side_top(false)}};
    if (notch_width <= 0.0) return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
    const double y_cut = y1 - notch_depth;
    if (notch_right) {
      return {{x0, y0}, {x1, y0}, {x1, y_cut}, {x1 - notch_width, y_cut}, {x1 - notch_width, y1}, {x0, y1}};
    }
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0 + notch_width, y1}, {x0 + notch_width, y_cut}, {x0, y_cut}};
  }
  /// Upper end of the side at x0 + width (right) or x0 (left).
  [[nodiscard]] double side_top(bool right) const {
    if (notch_right != right) return y0 + depth;
    return y0 + depth - (slope > 0.0 ? width * std::tan(slope) : notch_width > 0.0 ? notch_depth : 0.0);
  }
};

ShellPlan draw_shell(const SimOptions& options, int count, bool l_shape, Random& random) {
  ShellPlan plan;
  const double longest = count == 1 ? 9.0 : count == 2 ? 5.6 : 4.4;
  plan.width = random.uniform(l_shape ? 4.4 : 3.0, longest);
  plan.depth = random.uniform(l_shape ? 4.4 : 3.0, count == 1 ? 6.5 : longest - 0.2);
  if (l_shape) {
    plan.width = std::max(plan.width, 4.4);
    plan.depth = std::max(plan.depth, 4.4);
  }
  if (options.room_size) {
    plan.width = (*options.room_size)[0];
    plan.depth = (*options.room_size)[1];
  }
  if (l_shape && plan.width >= 4.0 && plan.depth >= 4.0) {
    plan.notch_width = random.uniform(0.3, 0.45) * plan.width;
    plan.notch_depth = random.uniform(0.3, 0.45) * plan.depth;
    plan.notch_right = random.chance(0.5);
  }
  return plan;
}

void add_faces(Building& building, int room) {
  const auto& polygon = building.rooms[static_cast<std::size_t>(room)].polygon;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    WallFace face;
    face.room = room;
    face.a = polygon[i];
    face.b = polygon[(i + 1) % polygon.size()];
    building.walls.push_back(face);
  }
}

/// Opens both faces of the partition at x = `x_left` | `x_left` + `thickness` around height `y` of the plan.
void open_doorway(Building& building, int left, double x_left, double thickness, double y) {
  for (auto& wall : building.walls) {
    const bool mine = (wall.room == left && std::abs(wall.a.x() - x_left) < 1e-9) ||
                      (wall.room == left + 1 && std::abs(wall.a.x() - x_left - thickness) < 1e-9);
    if (!mine || std::abs(wall.a.x() - wall.b.x()) > 1e-9) continue;
    const double u = (Vec2(wall.a.x(), y) - wall.a).dot(wall.along());
    if (u < 0.0 || u > wall.length()) continue;
    wall.doorway = std::pair(u - kDoorwayWidth / 2, u + kDoorwayWidth / 2);
  }
  building.doorways.push_back({left, left + 1, {x_left + thickness / 2, y}, 0.0, thickness});
}

void build_shells(Building& building, const SimOptions& options, Random& random) {
  // Offices of one or two rooms, as in the paper; now and then three.
  const double draw = random.uniform();
  const int count = options.rooms ? *options.rooms : draw < 0.45 ? 1 : draw < 0.85 ? 2 : 3;
  const int l_room = options.shell == Shell::Auto     ? (random.chance(0.35) ? random.integer(0, count - 1) : -1)
                     : options.shell == Shell::LShape ? random.integer(0, count - 1)
                                                      : -1;
  const double thickness = building.scene == Scene::ThinWall ? random.uniform(0.10, 0.20) : kUsualPartition;
  std::vector<ShellPlan> plans;
  for (int i = 0; i < count; ++i) {
    ShellPlan plan = draw_shell(options, count, i == l_room, random);
    if (i > 0) {
      const auto& last = plans.back();
      plan.x0 = last.x0 + last.width + thickness;
      plan.y0 = random.uniform(-0.8, 0.8);
      if (building.scene == Scene::Flat) plan.y0 = last.y0, plan.depth = last.depth;
    }
    if (building.scene == Scene::ObliqueWall) {
      plan.slope = std::min(radians(random.uniform(20.0, 40.0)), std::atan((plan.depth - 2.4) / plan.width));
      plan.notch_right = random.chance(0.5);
    }
    plans.push_back(plan);
    building.rooms.push_back({plan.polygon()});
    add_faces(building, i);
  }
  for (int i = 0; i + 1 < count; ++i) {
    const auto& left = plans[static_cast<std::size_t>(i)];
    const auto& right = plans[static_cast<std::size_t>(i) + 1];
    const double low = std::max(left.y0, right.y0), high = std::min(left.side_top(true), right.side_top(false));
    open_doorway(building, i, left.x0 + left.width, thickness, random.uniform(low + 0.75, high - 0.75));
  }
}

}  // namespace

std::array<Vec2, 4> Footprint::corners() const {
  const Vec2 x = direction(heading) * half.x(), y = left_of(direction(heading)) * half.y();
  return {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
}

double Footprint::distance(const Vec2& p) const {
  const Vec2 d = p - centre, x = direction(heading);
  const Vec2 out(std::max(std::abs(d.dot(x)) - half.x(), 0.0), std::max(std::abs(d.dot(left_of(x))) - half.y(), 0.0));
  return out.norm();
}

double gap(const Footprint& a, const Footprint& b) {
  double least = std::min(a.distance(b.centre), b.distance(a.centre));
  const auto ca = a.corners(), cb = b.corners();
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const Vec2 &a0 = ca[i], &a1 = ca[(i + 1) % 4], &b0 = cb[j], &b1 = cb[(j + 1) % 4];
      if (cross(a1 - a0, b0 - a0) * cross(a1 - a0, b1 - a0) < 0 &&
          cross(b1 - b0, a0 - b0) * cross(b1 - b0, a1 - b0) < 0) {
        return 0.0;
      }
      least = std::min({least, distance_to_piece(a0, b0, b1), distance_to_piece(b0, a0, a1)});
    }
  }
  return least;
}

bool Room::contains(const Vec2& p) const {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

Vec2 Room::middle() const {
  Vec2 low = polygon.front(), high = polygon.front();
  for (const auto& p : polygon) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (low + high) / 2;
}

bool Building::open_floor(const Vec2& p) const {
  for (const auto& room : rooms) {
    if (room.contains(p)) return true;
  }
  for (const auto& door : doorways) {
    const Footprint passage{door.centre, door.heading, {door.thickness / 2 + 0.01, kDoorwayWidth / 2}};
    if (passage.distance(p) == 0.0) return true;
  }
  return false;
}

double Building::clearance(const Vec2& p) const {
  if (!open_floor(p)) return 0.0;
  double least = 1e9;
  for (const auto& wall : walls) {
    const Vec2 d = wall.along();
    if (wall.doorway) {
      least = std::min(least, distance_to_piece(p, wall.a, wall.a + d * wall.doorway->first));
      least = std::min(least, distance_to_piece(p, wall.a + d * wall.doorway->second, wall.b));
    } else {
      least = std::min(least, distance_to_piece(p, wall.a, wall.b));
    }
  }
  for (const auto& obstacle : obstacles) least = std::min(least, obstacle.distance(p));
  return least;
}

std::vector<Stretch> free_stretches(const Building& building, const WallFace& wall) {
  std::vector<Stretch> blocked;
  for (const auto& other : building.walls) {  // nobody fits into an acute corner
    const bool after = other.room == wall.room && (other.a - wall.b).norm() < 1e-9;
    const bool before = other.room == wall.room && (other.b - wall.a).norm() < 1e-9;
    if (!after && !before) continue;
    const Vec2 d = after ? wall.along() : other.along(), next = after ? other.along() : wall.along();
    const double corner = kPi - std::atan2(cross(d, next), d.dot(next));
    if (corner > radians(80.0)) continue;
    const double margin = (0.3 + 0.45 * std::cos(corner)) / std::sin(corner) - 0.25;
    blocked.push_back(after ? Stretch{wall.length() - margin, wall.length()} : Stretch{0.0, margin});
  }
  if (wall.doorway) blocked.push_back({wall.doorway->first - 0.06, wall.doorway->second + 0.06});
  for (const auto& obstacle : building.obstacles) {
    double low = 1e9, high = -1e9, near = 1e9, far = -1e9;
    for (const auto& corner : obstacle.corners()) {
      const double u = (corner - wall.a).dot(wall.along()), off = (corner - wall.a).dot(wall.inward());
      low = std::min(low, u), high = std::max(high, u), near = std::min(near, off), far = std::max(far, off);
    }
    // What is flat on the wall stops the hand only, other things the body as well.
    if (near < 0.70 && far > 0.0 && high > 0.0 && low < wall.length()) {
      const double margin = far < 0.12 ? 0.05 : 0.33;
      blocked.push_back({low - margin, high + margin});
    }
  }
  std::sort(blocked.begin(), blocked.end(), [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::vector<Stretch> free;
  double at = 0.0;
  for (const auto& b : blocked) {
    if (b.from - at >= kShortestStretch) free.push_back({at, b.from});
    at = std::max(at, b.to);
  }
  if (wall.length() - at >= kShortestStretch) free.push_back({at, wall.length()});
  return free;
}

Building make_building(const SimOptions& options, const Reach& reach, Random& random) {
  Building building;
  building.scene = drawn_scene(options);
  build_shells(building, with_shell_of(building.scene, options, random), random);
  furnish(building, building.scene, reach, random);
  int id = 1;
  for (auto& wall : building.walls) wall.id = id++;
  for (auto& table : building.tables) table.id = id++;
  for (auto& screen : building.screens) screen.id = id++;
  for (auto& chair : building.chairs) chair.id = id++;
  return building;
}

}  // namespace kinemap::sim
