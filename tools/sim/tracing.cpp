// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/tracing.hpp"

#include "tools/sim/gesture.hpp"

namespace kinemap::sim {

namespace {

/// Edge k of a table top runs from corner k to corner k + 1; outward is to the right of it.
Vec2 outward_of(const std::array<Vec2, 4>& corners, std::size_t k) {
  return -left_of((corners[(k + 1) % 4] - corners[k]).normalized());
}

/// Whether one can stand along the whole edge.
bool can_walk_along(const Composer& composer, const std::array<Vec2, 4>& corners, std::size_t k) {
  const Vec2 n = outward_of(corners, k);
  for (const double u : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const Vec2 p = corners[k] + (corners[(k + 1) % 4] - corners[k]) * u + n * 0.32;
    const Vec2 q = composer.planner().pushed_clear(p, p, 0.28);
    // Beside a wall one stands a little further along the edge, but never far from it.
    if (composer.planner().clearance(q) < 0.25 || (q - p).norm() > (u == 0.5 ? 0.05 : 0.34)) return false;
    if (std::abs((q - p).dot(n)) > 0.12) return false;
  }
  return true;
}

/// Corner numbers in the order of touching; empty when the table cannot be traced.
std::vector<std::size_t> table_plan(Composer& composer, const std::array<Vec2, 4>& corners, bool& clockwise) {
  Random& random = composer.random();
  std::array<bool, 4> open{};
  int count = 0;
  for (std::size_t k = 0; k < 4; ++k) count += (open[k] = can_walk_along(composer, corners, k)) ? 1 : 0;
  const Habits& habits = composer.wearer().habits;
  const int wanted = count == 4 && random.chance(habits.whole_chance)   ? 4
                     : count >= 3 && random.chance(habits.three_chance) ? 3
                                                                        : 2;
  if (count < 2) return {};
  const auto start = static_cast<std::size_t>(random.integer(0, 3));
  clockwise = random.chance(0.65);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t first = (start + i) % 4;
    bool all = true;
    for (int e = 0; e < wanted; ++e) all = all && open[(first + static_cast<std::size_t>(e)) % 4];
    if (!all) continue;
    std::vector<std::size_t> order;
    for (int e = 0; e <= wanted; ++e) order.push_back((first + static_cast<std::size_t>(e)) % 4);
    if (clockwise) std::reverse(order.begin(), order.end());
    return order;
  }
  return {};
}

/// Room for a hand: no wall within 3 cm.
HandRoom hand_room(const Building& building) {
  return [&building](const Vec3& p) {
    const Vec2 q = p.head<2>();
    return building.open_floor(q) && std::all_of(building.walls.begin(), building.walls.end(), [&](const WallFace& w) {
             return distance_to_piece(q, w.a, w.b) > 0.03;
           });
  };
}

/// Makes a closed contour begin and end as this wearer's do: at a corner or along an edge; a little too far or too
/// short.
void begin_somewhere(Contour& contour, const Habits& habits, Random& random) {
  auto& v = contour.vertices;
  const Vec3 corner = v[0], d = (v[1] - corner).normalized();
  const double length = (v[1] - corner).norm();
  const double start = random.chance(habits.mid_edge_chance) ? random.uniform(0.2, 0.8) * length : 0.0;
  double end = start + random.uniform(-habits.end_miss_m, habits.end_past_m);
  // Who began along an edge may be content when all corners have been touched.
  if (start > 0.0 && random.chance(0.3 * habits.mid_edge_chance)) end = random.uniform(0.2, 1.0) * start;
  v.front() = corner + d * start;
  if (end > 0.03) {  // round the last corner
    v.push_back(corner + d * std::min(end, length - 0.05));
    contour.outward.push_back(contour.outward.front());
  } else {
    v.back() += (v[v.size() - 2] - v.back()).normalized() * std::max(0.0, -end);
  }
}

/// An open contour ends near its corners; of three sides one may be drawn in part only: the others give the size.
void miss_ends(Contour& contour, const Habits& habits, const HandRoom& has_room, Random& random) {
  auto& v = contour.vertices;
  const auto shift = [&](Vec3& end, const Vec3& next) {
    const Vec3 moved = end + (next - end).normalized() * random.uniform(-0.5, 1.0) * habits.end_miss_m;
    if (has_room(moved)) end = moved;
  };
  shift(v.front(), v[1]);
  shift(v.back(), v[v.size() - 2]);
  if (v.size() < 4 || !random.chance(0.5 * habits.mid_edge_chance)) return;
  const double part = random.uniform(0.2, 0.6);
  if (random.chance(0.5))
    v.front() += (v[1] - v.front()) * part;
  else
    v.back() += (v[v.size() - 2] - v.back()) * part;
}

Contour table_contour(const Table& table, const std::array<Vec2, 4>& corners, const std::vector<std::size_t>& order,
                      bool clockwise) {
  Contour contour;
  for (const auto k : order) contour.vertices.push_back(lift(corners[k], table.height));
  for (std::size_t e = 0; e + 1 < order.size(); ++e)
    contour.outward.push_back(lift(outward_of(corners, clockwise ? order[e + 1] : order[e]), 0));
  return contour;
}

Stroke table_stroke(Composer& composer, const Table& table, const Contour& contour, bool clockwise) {
  Random& random = composer.random();
  const Wearer& wearer = composer.wearer();
  const double speed = 1.15 * wearer.trace_speed * random.uniform(0.85, 1.15) * composer.speed_factor();
  const auto samples =
      run_along(contour, wearer.habits, speed, composer.score().rate_hz, hand_room(composer.building()), random);
  Stance stance;
  stance.standoff = random.uniform(0.26, 0.32);
  stance.face_turn = clockwise ? random.uniform(0.2, 0.8) : -random.uniform(0.0, 0.3);
  stance.to_left = 0.12;
  Stroke stroke = accompany(composer, table.id, samples, stance);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 in = lift(direction(stroke.heading[i] - stance.face_turn), 0);
    const Vec3 fingers = wearer.palm ? in : Vec3(in * 0.85 - Vec3::UnitZ() * 0.5);
    stroke.touch.push_back({samples[i].p, fingers.normalized(), -Vec3::UnitZ()});
  }
  return stroke;
}

// ---- screens ----

Contour screen_contour(Random& random, const Screen& screen, const Habits& habits) {
  const Vec3 n = lift(direction(screen.heading), 0),
             x = Vec3::UnitZ().cross(n);  // to the right of who looks at it is +x
  const Vec3 right = x * (screen.width / 2), up = Vec3::UnitZ() * (screen.height / 2);
  std::array<Vec3, 4> corners{screen.centre - right - up, screen.centre + right - up, screen.centre + right + up,
                              screen.centre - right + up};
  if (random.chance(0.5)) std::reverse(corners.begin(), corners.end());
  const auto start = static_cast<std::size_t>(random.integer(0, 3));
  Contour contour;
  contour.surface = n;
  for (std::size_t i = 0; i <= 4; ++i) contour.vertices.push_back(corners[(start + i) % 4]);
  contour.outward.assign(4, n);
  begin_somewhere(contour, habits, random);
  return contour;
}

Stroke screen_stroke(Composer& composer, const Screen& screen) {
  Random& random = composer.random();
  const Wearer& wearer = composer.wearer();
  const Contour contour = screen_contour(random, screen, wearer.habits);
  const double speed =
      (screen.big ? 1.2 : 0.8) * wearer.trace_speed * random.uniform(0.85, 1.15) * composer.speed_factor();
  const auto samples =
      run_along(contour, wearer.habits, speed, composer.score().rate_hz, hand_room(composer.building()), random);
  Stance stance;
  stance.standoff = random.uniform(0.36, 0.44) * wearer.body.stature / 1.75 - (wearer.palm ? 0.06 : 0.0);
  stance.face_turn = random.uniform(-0.15, 0.25);
  stance.to_left = random.uniform(0.10, 0.18);
  stance.follow_s = 0.6;
  Stroke stroke = accompany(composer, screen.id, samples, stance);
  if (screen.table >= 0) {  // reaches over the table, standing still
    const Table& table = composer.building().tables[static_cast<std::size_t>(screen.table)];
    const Vec2 out = direction(screen.heading), left = left_of(direction(stroke.heading.front()));
    const double edge = table.top.half.y() - (screen.centre.head<2>() - table.top.centre).dot(out);
    const Vec2 spot = screen.centre.head<2>() + out * (edge + random.uniform(0.21, 0.25)) + left * stance.to_left;
    std::fill(stroke.ground.begin(), stroke.ground.end(), composer.planner().pushed_clear(spot, spot + out * 0.1, 0.2));
  }
  const Vec3 n = contour.surface, up = Vec3::UnitZ();
  const Vec3 fingers = wearer.palm ? Vec3(up) : Vec3(-n * 0.8 + up * 0.4);
  for (const auto& s : samples) stroke.touch.push_back({s.p, fingers.normalized(), -n});
  return stroke;
}

}  // namespace

std::vector<int> trace_table(Composer& composer, const Table& table) {
  Random& random = composer.random();
  const Habits& habits = composer.wearer().habits;
  const auto corners = table.top.corners();
  bool clockwise = true;
  const auto order = table_plan(composer, corners, clockwise);
  if (order.empty()) return {};
  if (random.chance(habits.split_chance)) {
    const auto edges = static_cast<int>(order.size()) - 1;
    const long join = random.integer(1, edges - 1);
    std::vector<int> drawn;
    for (const int part : {1, 2}) {
      const std::vector<std::size_t> corner_numbers(part == 1 ? order.begin() : order.begin() + join,
                                                    part == 1 ? order.begin() + join + 1 : order.end());
      Contour contour = table_contour(table, corners, corner_numbers, clockwise);
      miss_ends(contour, habits, hand_room(composer.building()), random);
      Stroke stroke = table_stroke(composer, table, contour, clockwise);
      stroke.part = part, stroke.parts = 2;
      drawn = perform(composer, {stroke});
      if (part == 1) composer.stand(random.uniform(1.0, 5.0));
    }
    return drawn;
  }
  Contour contour = table_contour(table, corners, order, clockwise);
  if (order.front() == order.back())
    begin_somewhere(contour, habits, random);
  else
    miss_ends(contour, habits, hand_room(composer.building()), random);
  return perform(composer, {table_stroke(composer, table, contour, clockwise)});
}

std::vector<int> trace_screens(Composer& composer, const std::vector<const Screen*>& screens) {
  std::vector<Stroke> strokes;
  for (const auto* screen : screens) strokes.push_back(screen_stroke(composer, *screen));
  return perform(composer, strokes);
}

}  // namespace kinemap::sim
