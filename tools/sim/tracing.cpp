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
  const int wanted = count == 4 && random.chance(0.6) ? 4 : count >= 3 && random.chance(0.25) ? 3 : 2;
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

Contour table_contour(Composer& composer, const Table& table, const std::array<Vec2, 4>& corners,
                      const std::vector<std::size_t>& order, bool clockwise) {
  Random& random = composer.random();
  Contour contour;
  const bool closed = order.front() == order.back();
  for (const auto k : order) contour.vertices.push_back(lift(corners[k], table.height));
  for (std::size_t e = 0; e + 1 < order.size(); ++e)
    contour.outward.push_back(lift(outward_of(corners, clockwise ? order[e + 1] : order[e]), 0));
  if (closed && random.chance(0.6)) {  // starts somewhere along an edge instead of at a corner
    const Vec3 start = contour.vertices[0] + (contour.vertices[1] - contour.vertices[0]) * random.uniform(0.25, 0.75);
    contour.vertices.front() = start;
    contour.vertices.push_back(start);
    contour.vertices[contour.vertices.size() - 2] = lift(corners[order.back()], table.height);
    contour.outward.push_back(contour.outward.front());
  } else if (!closed) {
    contour.vertices.front() += (contour.vertices[1] - contour.vertices[0]).normalized() * random.uniform(0.0, 0.02);
  }
  if (closed) {  // overshoots, then lets go
    const Vec3 d = (contour.vertices[1] - contour.vertices[0]).normalized();
    if ((contour.vertices.back() - contour.vertices[contour.vertices.size() - 2]).normalized().dot(d) > 0.99) {
      contour.vertices.back() += d * random.uniform(-0.02, 0.10);
    }
  }
  return contour;
}

// ---- screens ----

Contour screen_contour(Random& random, const Screen& screen) {
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
  if (random.chance(0.4)) {
    const Vec3 s = contour.vertices[0] + (contour.vertices[1] - contour.vertices[0]) * random.uniform(0.2, 0.8);
    contour.vertices.front() = s;
    contour.vertices.push_back(s);
  }
  // Closed within a few centimetres: a little too far or not quite.
  const Vec3 d = (contour.vertices.back() - contour.vertices[contour.vertices.size() - 2]).normalized();
  const bool corner_end = contour.vertices.size() == 5;
  contour.vertices.back() += d * (corner_end ? random.uniform(-0.02, 0.01) : random.uniform(-0.02, 0.08));
  contour.outward.assign(contour.vertices.size() - 1, n);
  return contour;
}

TracingHabit habit_of(Composer& composer, double factor) {
  const Wearer& w = composer.wearer();
  const double speed = w.trace_speed * composer.random().uniform(0.85, 1.15) * factor * composer.speed_factor();
  return {speed, w.sloppiness};
}

}  // namespace

bool trace_table(Composer& composer, const Table& table) {
  Random& random = composer.random();
  const auto corners = table.top.corners();
  bool clockwise = true;
  const auto order = table_plan(composer, corners, clockwise);
  if (order.empty()) return false;
  const Contour contour = table_contour(composer, table, corners, order, clockwise);
  const auto samples = run_along(contour, habit_of(composer, 1.15), composer.score().rate_hz, random);
  Stance stance;
  stance.standoff = random.uniform(0.26, 0.32);
  stance.face_turn = clockwise ? random.uniform(0.2, 0.8) : -random.uniform(0.0, 0.3);
  stance.to_left = 0.12;
  Gesture gesture = accompany(composer, samples, stance);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 in = lift(direction(gesture.heading[i] - stance.face_turn), 0);
    const Vec3 fingers = composer.wearer().palm ? in : Vec3(in * 0.85 - Vec3::UnitZ() * 0.5);
    gesture.touch.push_back({samples[i].p, fingers.normalized(), -Vec3::UnitZ()});
  }
  return perform(composer, gesture, table.id);
}

bool trace_screen(Composer& composer, const Screen& screen) {
  Random& random = composer.random();
  const Contour contour = screen_contour(random, screen);
  const auto samples = run_along(contour, habit_of(composer, screen.big ? 1.2 : 0.8), composer.score().rate_hz, random);
  Stance stance;
  stance.standoff =
      random.uniform(0.36, 0.44) * composer.wearer().body.stature / 1.75 - (composer.wearer().palm ? 0.06 : 0.0);
  stance.face_turn = random.uniform(-0.15, 0.25);
  stance.to_left = random.uniform(0.10, 0.18);
  stance.follow_s = 0.6;
  Gesture gesture = accompany(composer, samples, stance);
  if (screen.table >= 0) {  // reaches over the table, standing still
    const Table& table = composer.building().tables[static_cast<std::size_t>(screen.table)];
    const Vec2 out = direction(screen.heading), left = left_of(direction(gesture.heading.front()));
    const double edge = table.top.half.y() - (screen.centre.head<2>() - table.top.centre).dot(out);
    const Vec2 spot = screen.centre.head<2>() + out * (edge + random.uniform(0.21, 0.25)) + left * stance.to_left;
    std::fill(gesture.ground.begin(), gesture.ground.end(),
              composer.planner().pushed_clear(spot, spot + out * 0.1, 0.2));
  }
  const Vec3 n = contour.surface, up = Vec3::UnitZ();
  const Vec3 fingers = composer.wearer().palm ? Vec3(up) : Vec3(-n * 0.8 + up * 0.4);
  for (const auto& s : samples) gesture.touch.push_back({s.p, fingers.normalized(), -n});
  return perform(composer, gesture, screen.id);
}

}  // namespace kinemap::sim
