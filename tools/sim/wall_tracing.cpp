// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/gesture.hpp"
#include "tools/sim/tracing.hpp"

namespace kinemap::sim {

namespace {

constexpr double kShortestStretch = 0.8;

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

}  // namespace kinemap::sim
