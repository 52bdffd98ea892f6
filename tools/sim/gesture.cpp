// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/gesture.hpp"

namespace kinemap::sim {

namespace {

constexpr double kBodyClear = 0.26;  ///< pelvis to anything, m

/// Whether the body can simply turn and shift from where it is to where the next stroke begins.
bool is_near(const Composer& c, const Stroke& next) {
  const Vec2 from = c.position(), to = next.ground.front();
  if ((to - from).norm() > 0.9) return false;
  for (const double u : {0.25, 0.5, 0.75}) {
    if (c.planner().clearance(from + (to - from) * u) < 0.2) return false;
  }
  return true;
}

/// The hand goes straight over from one object to the next, hardly leaving the surface.
void shift_over(Composer& c, const Stroke& next) {
  const Vec2 from = c.position(), way = next.ground.front() - from;
  const double heading = c.heading(), turn = wrapped(next.heading.front() - heading);
  auto& hand = c.score().touches.back().points;
  const TouchPoint before = hand.back(), after = next.touch.front();
  const double reach = (after.p - before.p).norm();
  const double seconds = std::max({0.4, std::abs(turn) / 1.6, way.norm() / 0.7, reach / 0.6});
  const Vec3 away = -(before.palm + after.palm).normalized() * std::min(0.05, 0.15 * reach);
  const std::size_t n = c.frames(seconds * c.random().uniform(1.0, 1.3));
  std::vector<Vec2> ground;
  std::vector<double> headings;
  for (std::size_t i = 1; i <= n; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(n), s = smooth_step(u);
    ground.push_back(from + way * s);
    headings.push_back(heading + turn * s);
    hand.push_back({before.p + (after.p - before.p) * s + away * 4.0 * s * (1.0 - s),
                    before.fingers + (after.fingers - before.fingers) * s,
                    before.palm + (after.palm - before.palm) * s});
  }
  c.follow(ground, headings);
}

/// On to the next object with the left hand on the hip. Time of contact; nullopt when there is no way.
std::optional<double> go_over(Composer& c, const Stroke& next) {
  if (is_near(c, next)) {
    shift_over(c, next);
    return c.now();
  }
  const double leave = c.now();
  if (!c.walk_to(next.ground.front(), next.heading.front())) return std::nullopt;
  c.score().right.to(leave, leave + c.random().uniform(0.5, 0.9), c.hang(Side::Right));
  return c.reach_out(c.now());
}

void follow(Composer& c, const Stroke& stroke) {
  auto& touches = c.score().touches;
  const std::size_t frame = c.score().frames();
  // Straight over from the stroke before, the hand's way has no gap.
  if (touches.empty() || touches.back().first + touches.back().points.size() != frame) touches.push_back({frame, {}});
  auto& points = touches.back().points;
  points.insert(points.end(), stroke.touch.begin(), stroke.touch.end());
  c.follow(stroke.ground, stroke.heading);
}

std::vector<std::pair<double, double>> lift_offs(const Stroke& stroke, double begin_s, double rate_hz) {
  std::vector<std::pair<double, double>> out;
  for (std::size_t i = 0; i < stroke.lifted.size(); ++i) {
    if (!stroke.lifted[i]) continue;
    const double t = begin_s + static_cast<double>(i) / rate_hz;
    if (i == 0 || !stroke.lifted[i - 1]) out.emplace_back(t, t);
    out.back().second = t;
  }
  return out;
}

}  // namespace

Stroke accompany(Composer& composer, int object, const std::vector<ContourSample>& samples, const Stance& stance) {
  const double rate = composer.score().rate_hz;
  Stroke stroke;
  stroke.object = object;
  std::vector<Vec2> hand, outward;
  for (const auto& s : samples) {
    hand.push_back(s.p.head<2>());
    outward.push_back(s.outward.head<2>());
    stroke.lifted.push_back(s.lifted);
  }
  smooth_samples(hand, stance.follow_s * rate);
  smooth_samples(outward, 0.65 * rate);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2 n = outward[i].normalized();
    const double heading = heading_of(-n) + stance.face_turn;
    const Vec2 aside = left_of(direction(heading)) * stance.to_left - left_of(-n) * stance.lag;
    stroke.ground.push_back(
        composer.planner().pushed_clear(hand[i] + n * stance.standoff + aside, hand[i] + n * 0.35, kBodyClear));
    stroke.heading.push_back(heading);
  }
  smooth_samples(stroke.ground, 0.2 * rate);
  return stroke;
}

std::vector<int> perform(Composer& composer, const std::vector<Stroke>& strokes) {
  if (!composer.walk_to(strokes[0].ground.front(), strokes[0].heading.front())) return {};
  const auto [begin, first_contact] = composer.begin_gesture();
  std::vector<Interval> intervals;
  std::vector<int> drawn;
  double from = begin, contact = first_contact;
  for (const auto& stroke : strokes) {
    if (!intervals.empty()) {
      const auto over = go_over(composer, stroke);
      if (!over) break;
      contact = *over;
      intervals.back().end_s = from = 0.5 * (intervals.back().contact_end_s + contact);
    }
    follow(composer, stroke);
    intervals.push_back({from, 0.0, "trace", stroke.object, contact, composer.now(), composer.gestures(), stroke.part,
                         stroke.parts, lift_offs(stroke, contact, composer.score().rate_hz)});
    drawn.push_back(stroke.object);
  }
  intervals.back().end_s = composer.end_gesture();
  for (const auto& interval : intervals) composer.label(interval);
  return drawn;
}

}  // namespace kinemap::sim
