// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/tracing.hpp"

#include "tools/sim/contour.hpp"

namespace kinemap::sim {

namespace {

constexpr double kBodyClear = 0.26;  ///< pelvis to anything, m
constexpr double kShortestStretch = 0.8;

/// How the body goes along with the hand.
struct Stance {
  double standoff = 0.3;   ///< pelvis from the touched line, m
  double face_turn = 0.0;  ///< heading minus the direction to the surface, rad
  double lag = 0.0;        ///< pelvis behind a hand that goes to the left along the surface, m
  double to_left = 0.15;   ///< pelvis to its own left of the hand, m: the right hand is the pen
  double follow_s = 0.5;   ///< smoothing of the body's way
};

/// The motion of one gesture: hand samples and the body with them.
struct Gesture {
  std::vector<TouchPoint> touch;
  std::vector<Vec2> ground;
  std::vector<double> heading;
};

Gesture accompany(Composer& composer, const std::vector<ContourSample>& samples, const Stance& stance) {
  const double rate = composer.score().rate_hz;
  std::vector<Vec2> hand, outward;
  for (const auto& s : samples) {
    hand.push_back(s.p.head<2>());
    outward.push_back(s.outward.head<2>());
  }
  smooth_samples(hand, stance.follow_s * rate);
  smooth_samples(outward, 0.65 * rate);
  Gesture gesture;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2 n = outward[i].normalized();
    const double heading = heading_of(-n) + stance.face_turn;
    const Vec2 aside = left_of(direction(heading)) * stance.to_left - left_of(-n) * stance.lag;
    gesture.ground.push_back(
        composer.planner().pushed_clear(hand[i] + n * stance.standoff + aside, hand[i] + n * 0.35, kBodyClear));
    gesture.heading.push_back(heading);
  }
  smooth_samples(gesture.ground, 0.2 * rate);
  return gesture;
}

/// Walks to the start, makes the gesture, and labels it. False when one cannot get there.
bool perform(Composer& composer, const Gesture& gesture, int object) {
  if (!composer.walk_to(gesture.ground.front(), gesture.heading.front())) return false;
  const double begin = composer.now();
  const double contact = composer.begin_gesture();
  composer.score().touches.push_back({composer.score().frames(), gesture.touch});
  composer.follow(gesture.ground, gesture.heading);
  const double contact_end = composer.now();
  composer.end_gesture();
  composer.label({begin, composer.now(), "trace", object, contact, contact_end});
  return true;
}

// ---- walls ----

struct Stretch {
  double from = 0.0, to = 0.0;  ///< metres from the face's start
};

/// Parts of the face that nothing keeps one from touching.
std::vector<Stretch> free_stretches(const Building& building, const WallFace& wall) {
  std::vector<Stretch> blocked;
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

/// Hand waving up and down between 0.9 and 1.6 m on its way.
std::vector<ContourSample> wall_samples(Composer& composer, const WallFace& wall, double from, double to,
                                        double speed) {
  Random& random = composer.random();
  const double base = random.uniform(1.15, 1.35), swing = random.chance(0.8) ? random.uniform(0.08, 0.28) : 0.03;
  const double wave = random.uniform(0.8, 2.2), phase = random.uniform(0.0, 2 * kPi);
  Contour contour;
  contour.surface = lift(wall.inward(), 0);
  const int pieces = std::max(2, static_cast<int>(std::abs(to - from) / 0.1));
  const double dt = 1.0 / composer.score().rate_hz;
  std::vector<ContourSample> samples;
  Wander off(0.0025, 0.5, random);
  std::vector<double> pace(static_cast<std::size_t>(pieces) + 2);
  for (auto& p : pace) p = random.uniform(0.75, 1.25);
  const double sense = to > from ? 1.0 : -1.0;
  for (double s = 0.0; s < std::abs(to - from);) {
    const double u = s / std::abs(to - from) * pieces;
    const auto k = static_cast<std::size_t>(u);
    const double factor = pace[k] + (pace[k + 1] - pace[k]) * (u - std::floor(u));
    const double ends = std::clamp(std::min(s, std::abs(to - from) - s) / 0.25, 0.25, 1.0);
    const double z = base + swing * std::sin(2 * kPi * s / wave + phase);
    const Vec2 p = wall.a + wall.along() * (from + sense * s);
    samples.push_back(
        {lift(p, std::clamp(z, 0.9, 1.6)) + contour.surface * std::abs(off.step(dt, random)), contour.surface});
    s += speed * factor * ends * dt;
  }
  return samples;
}

bool trace_stretch(Composer& composer, const WallFace& wall, double from, double to, bool wall_at_right) {
  Random& random = composer.random();
  // Going a → b the wall is at the right; facing the wall one steps sideways, more slowly.
  const bool along = wall_at_right && to > from;
  const double speed = composer.speed_factor() * (along ? random.uniform(0.45, 0.70) : random.uniform(0.26, 0.38));
  const auto samples = wall_samples(composer, wall, from, to, speed);
  Stance stance;
  stance.follow_s = 0.35;
  if (along) {
    stance.standoff = random.uniform(0.42, 0.52);
    stance.face_turn = kPi / 2 - random.uniform(0.1, 0.5);
    stance.to_left = 0.0;
    stance.lag = random.uniform(0.1, 0.25);  // the hand goes before the body
  } else {
    stance.standoff = random.uniform(0.42, 0.50);
    stance.face_turn = random.uniform(-0.15, 0.35);
    stance.to_left = 0.18;
  }
  Gesture gesture = accompany(composer, samples, stance);
  const Vec3 n = lift(wall.inward(), 0), d = lift(wall.along(), 0) * (to > from ? 1.0 : -1.0);
  const Vec3 up = Vec3::UnitZ();
  const Vec3 fingers =
      composer.wearer().palm ? Vec3(up * 0.8 + d * 0.6) : Vec3(-n * 0.75 + up * 0.5 + d * (along ? 0.4 : 0.1));
  // Finger tips touch a wall at the right with the palm down, a wall in front with the palm to it.
  const Vec3 palm = composer.wearer().palm || !along ? Vec3(-n) : Vec3(-up * 0.8 + d * 0.3 - n * 0.3);
  for (const auto& s : samples) gesture.touch.push_back({s.p, fingers.normalized(), palm});
  return perform(composer, gesture, wall.id);
}

// ---- tables ----

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

bool trace_wall(Composer& composer, const WallFace& wall, bool wall_at_right, WallExtent extent) {
  Random& random = composer.random();
  auto stretches = free_stretches(composer.building(), wall);
  if (stretches.empty()) return false;
  std::sort(stretches.begin(), stretches.end(),
            [](const Stretch& a, const Stretch& b) { return a.to - a.from > b.to - b.from; });
  std::vector<Stretch> chosen{stretches.front()};
  for (std::size_t i = 1; i < stretches.size() && extent == WallExtent::All; ++i) {
    if (stretches[i].to - stretches[i].from > 1.2 && random.chance(0.7)) chosen.push_back(stretches[i]);
  }
  const bool forward = wall_at_right || random.chance(0.5);
  std::sort(chosen.begin(), chosen.end(),
            [&](const Stretch& a, const Stretch& b) { return forward ? a.from < b.from : a.from > b.from; });
  bool done = false;
  for (const auto& stretch : chosen) {
    // Not right into the corner: 0.1–0.5 m are left out at each end.
    const double most = std::min(0.5, 0.2 * (stretch.to - stretch.from));
    double from = stretch.from + random.uniform(0.1, std::max(0.12, most)),
           to = stretch.to - random.uniform(0.1, std::max(0.12, most));
    if (extent == WallExtent::Brief && to - from > 1.6) {
      const double length = random.uniform(1.1, 1.6);
      from += random.uniform(0.0, to - from - length);
      to = from + length;
    }
    if (!forward) std::swap(from, to);
    done = trace_stretch(composer, wall, from, to, wall_at_right) || done;
  }
  return done;
}

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
