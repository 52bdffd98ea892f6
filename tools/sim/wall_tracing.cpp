// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/gesture.hpp"
#include "tools/sim/tracing.hpp"

namespace kinemap::sim {

namespace {

/// Hand waving up and down between 0.9 and 1.6 m on its way, at about `speed` m/s.
std::vector<ContourSample> wall_samples(Composer& composer, const WallFace& wall, const Stretch& stretch,
                                        double speed) {
  Random& random = composer.random();
  const Habits& habits = composer.wearer().habits;
  const double base = random.uniform(1.15, 1.35), swing = random.chance(0.8) ? random.uniform(0.08, 0.28) : 0.03;
  const double wave = random.uniform(0.8, 2.2), phase = random.uniform(0.0, 2 * kPi);
  const double length = std::abs(stretch.to - stretch.from), sense = stretch.to > stretch.from ? 1.0 : -1.0;
  const Vec3 n = lift(wall.inward(), 0);
  const double dt = 1.0 / composer.score().rate_hz;
  std::vector<ContourSample> samples;
  Wander off(0.0025, 0.5, random);
  std::vector<double> pace(static_cast<std::size_t>(length / 0.1) + 2);
  for (auto& p : pace) p = std::max(0.3, 1.0 + random.uniform(-1.0, 1.0) * (0.12 + 1.2 * habits.pace_spread));
  double rest_s = 0.0;
  for (double s = 0.0; s < length;) {
    const auto k = static_cast<std::size_t>(s / 0.1);
    const double factor = pace[k] + (pace[k + 1] - pace[k]) * (s / 0.1 - std::floor(s / 0.1));
    const double ends = std::clamp(std::min(s, length - s) / 0.25, 0.25, 1.0);
    const double z = base + swing * std::sin(2 * kPi * s / wave + phase);
    const Vec2 p = wall.a + wall.along() * (stretch.from + sense * s);
    samples.push_back({lift(p, std::clamp(z, 0.9, 1.6)) + n * std::abs(off.step(dt, random)), n});
    rest_s -= dt;
    if (rest_s > 0.0) continue;
    const double step = speed * factor * ends * dt;
    if (random.chance(habits.pause_per_m * step)) rest_s = random.uniform(0.3, 1.0) * habits.pause_s;
    s += step;
  }
  lift_off(samples, n, {samples.front().p, samples.back().p}, habits, composer.score().rate_hz, random);
  return samples;
}

Stroke wall_stroke(Composer& composer, const WallFace& wall, const Stretch& stretch, bool wall_at_right) {
  Random& random = composer.random();
  // Going a → b the wall is at the right; facing the wall one steps sideways, more slowly.
  const bool along = wall_at_right && stretch.to > stretch.from;
  const double speed = composer.speed_factor() * (along ? random.uniform(0.45, 0.70) : random.uniform(0.26, 0.38));
  const auto samples = wall_samples(composer, wall, stretch, speed);
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
  Stroke stroke = accompany(composer, wall.id, samples, stance);
  const bool forward = stretch.to > stretch.from, palm_flat = composer.wearer().palm;
  const Vec3 n = lift(wall.inward(), 0), d = lift(wall.along(), 0) * (forward ? 1.0 : -1.0);
  const Vec3 up = Vec3::UnitZ();
  const Vec3 fingers = palm_flat ? Vec3(up * 0.8 + d * 0.6) : Vec3(-n * 0.75 + up * 0.5 + d * (along ? 0.4 : 0.1));
  // Finger tips touch a wall at the right with the palm down, a wall in front with the palm to it.
  const Vec3 palm = palm_flat || !along ? Vec3(-n) : Vec3(-up * 0.8 + d * 0.3 - n * 0.3);
  for (const auto& s : samples) stroke.touch.push_back({s.p, fingers.normalized(), palm});
  return stroke;
}

/// 0.1–0.5 m are left out at the end of a stretch: not right into the corner.
double left_out(const Stretch& stretch, Random& random) {
  return random.uniform(0.1, std::max(0.12, std::min(0.5, 0.2 * (stretch.to - stretch.from))));
}

}  // namespace

std::vector<int> trace_wall(Composer& composer, const WallFace& wall, bool wall_at_right, WallExtent extent) {
  Random& random = composer.random();
  auto stretches = free_stretches(composer.building(), wall);
  if (stretches.empty()) return {};
  std::sort(stretches.begin(), stretches.end(),
            [](const Stretch& a, const Stretch& b) { return a.to - a.from > b.to - b.from; });
  std::vector<Stretch> chosen{stretches.front()};
  for (std::size_t i = 1; i < stretches.size() && extent == WallExtent::All; ++i) {
    if (stretches[i].to - stretches[i].from > 1.2 && random.chance(0.7)) chosen.push_back(stretches[i]);
  }
  const bool forward = wall_at_right || random.chance(0.5);
  std::sort(chosen.begin(), chosen.end(),
            [&](const Stretch& a, const Stretch& b) { return forward ? a.from < b.from : a.from > b.from; });
  std::vector<int> drawn;
  for (const auto& stretch : chosen) {
    Stretch part{stretch.from + left_out(stretch, random), stretch.to - left_out(stretch, random)};
    if (extent == WallExtent::Brief && part.to - part.from > 1.6) {
      const double length = random.uniform(1.1, 1.6);
      part.from += random.uniform(0.0, part.to - part.from - length);
      part.to = part.from + length;
    }
    if (!forward) std::swap(part.from, part.to);
    const auto done = perform(composer, {wall_stroke(composer, wall, part, wall_at_right)});
    if (!done.empty()) drawn = done;
  }
  return drawn;
}

std::vector<int> trace_wall_corner(Composer& composer, const WallFace& first, const WallFace& second,
                                   bool wall_at_right) {
  Random& random = composer.random();
  const auto before = free_stretches(composer.building(), first), after = free_stretches(composer.building(), second);
  if (before.empty() || after.empty() || before.back().to < first.length() - 1e-6 || after.front().from > 1e-6)
    return {};
  const Stretch in{before.back().from + left_out(before.back(), random), first.length() - random.uniform(0.06, 0.2)};
  const Stretch out{random.uniform(0.06, 0.2), after.front().to - left_out(after.front(), random)};
  return perform(composer,
                 {wall_stroke(composer, first, in, wall_at_right), wall_stroke(composer, second, out, wall_at_right)});
}

}  // namespace kinemap::sim
