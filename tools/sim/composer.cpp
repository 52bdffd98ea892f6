// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/composer.hpp"

namespace kinemap::sim {

namespace {

constexpr double kTurnRate = 2.0;      ///< rad/s, on the spot
constexpr double kCurveRate = 1.5;     ///< rad/s, while walking
constexpr double kAcceleration = 0.9;  ///< m/s²

/// Distance from the start to each point of a path.
std::vector<double> arc_lengths(const std::vector<Vec2>& path) {
  std::vector<double> s(path.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) s[i] = s[i - 1] + (path[i] - path[i - 1]).norm();
  return s;
}

/// Heading of the path about each point, looking 0.25 m around; unwrapped.
std::vector<double> headings(const std::vector<Vec2>& path, const std::vector<double>& s) {
  std::vector<double> out(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    std::size_t a = i, b = i;
    while (a > 0 && s[i] - s[a] < 0.12) --a;
    while (b + 1 < path.size() && s[b] - s[i] < 0.25) ++b;
    out[i] = heading_of(path[b] - path[a]);
    if (i > 0) out[i] = out[i - 1] + wrapped(out[i] - out[i - 1]);
  }
  return out;
}

/// Speed at each point: slower in curves, no faster than one can speed up and brake.
std::vector<double> speeds(const std::vector<double>& s, const std::vector<double>& heading, double cruise) {
  std::vector<double> v(s.size(), cruise);
  for (std::size_t i = 1; i + 1 < s.size(); ++i) {
    const double curvature = std::abs(heading[i + 1] - heading[i - 1]) / std::max(1e-6, s[i + 1] - s[i - 1]);
    v[i] = std::clamp(kCurveRate / std::max(curvature, 1e-6), 0.25, cruise);
  }
  v.front() = v.back() = 0.15;
  for (std::size_t i = 1; i < s.size(); ++i)
    v[i] = std::min(v[i], std::sqrt(v[i - 1] * v[i - 1] + 2 * kAcceleration * (s[i] - s[i - 1])));
  for (std::size_t i = s.size() - 1; i > 0; --i)
    v[i - 1] = std::min(v[i - 1], std::sqrt(v[i] * v[i] + 2 * kAcceleration * (s[i] - s[i - 1])));
  return v;
}

}  // namespace

Composer::Composer(const SimOptions& options, const Building& building, const Wearer& wearer, Random& random)
    : building_(building),
      planner_(building),
      wearer_(wearer),
      random_(random),
      speed_(options.speed),
      score_(options.rate_hz, postures::hanging(wearer, Side::Right), postures::hanging(wearer, Side::Left)) {}

void Composer::push(const Vec2& ground, double heading) {
  if (!score_.ground.empty()) walked_ += (ground - score_.ground.back()).norm();
  score_.ground.push_back(ground);
  score_.heading.push_back(heading);
}

void Composer::stand(double seconds) {
  const Vec2 p = position();
  const double h = heading();
  for (std::size_t i = frames(seconds); i > 0; --i) push(p, h);
}

void Composer::turn_to(double heading_wanted) {
  const double from = heading(), turn = wrapped(heading_wanted - from);
  if (std::abs(turn) < 0.02) return;
  const Vec2 p = position();
  const std::size_t n = frames(0.3 + std::abs(turn) / (kTurnRate * speed_));
  for (std::size_t i = 1; i <= n; ++i)
    push(p, from + turn * smooth_step(static_cast<double>(i) / static_cast<double>(n)));
}

bool Composer::walk_to(const Vec2& goal, std::optional<double> final_heading) {
  const double distance = (goal - position()).norm(), begin = now();
  if (distance > 0.03) {
    const auto path = planner_.way(position(), goal);
    if (path.size() < 2) return false;
    const auto s = arc_lengths(path);
    auto h = headings(path, s);
    const bool shuffle = s.back() < 0.45;  // a step or two: no need to turn that way
    if (!shuffle && std::abs(wrapped(h.front() - heading())) > 0.5) turn_to(h.front());
    const auto v = speeds(s, h, wearer_.walk_speed * speed_ * random_.uniform(0.9, 1.1));
    const double fix = std::remainder(h.front() - heading(), 2 * kPi) + heading() - h.front();
    const double hold = heading();
    double at = 0.0;
    for (std::size_t i = 0; at < s.back();) {
      at = std::min(s.back(), at + v[i] / score_.rate_hz);
      while (i + 2 < s.size() && s[i + 1] <= at) ++i;
      const double u = std::clamp((at - s[i]) / std::max(1e-9, s[i + 1] - s[i]), 0.0, 1.0);
      push(path[i] + (path[i + 1] - path[i]) * u, shuffle ? hold : h[i] + (h[i + 1] - h[i]) * u + fix);
    }
  }
  if (distance > 0.45) label({begin, now(), "walk", 0, -1, -1});
  if (final_heading) turn_to(*final_heading);
  return true;
}

void Composer::follow(const std::vector<Vec2>& ground, const std::vector<double>& heading_wanted) {
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const double h = heading();
    push(ground[i], h + wrapped(heading_wanted[i] - h));
  }
}

ArmGoal Composer::hip_goal() {
  return postures::on_hip(wearer_, Side::Left, hip_of_gesture(wearer_.habits, wearer_.sloppiness, random_));
}

Composer::Lead Composer::begin_gesture() {
  ++gestures_;
  // The left hand may leave before one stands still.
  const double early = random_.uniform(0.0, wearer_.habits.lead_s), raise = random_.uniform(0.45, 0.75);
  const double begin = std::max(now() - early, score_.left.last_end()), on_hip = begin + raise;
  score_.left.to(begin, on_hip, hip_goal());
  return {begin, reach_out(on_hip + random_.uniform(0.2, 0.8))};
}

double Composer::reach_out(double earliest_s) {
  const double reach = random_.uniform(0.5, 0.9);
  const double contact = std::max({earliest_s, now() + 0.2, score_.right.last_end() + reach});
  score_.right.to(contact - reach, contact, postures::touching(score_.touches.size()));
  stand(contact - now());
  return contact;
}

double Composer::end_gesture() {
  const double leave = now(), let_go = leave + random_.uniform(0.05, wearer_.habits.trail_s);
  score_.right.to(leave, leave + random_.uniform(0.5, 0.9), hang(Side::Right));
  score_.left.to(let_go, let_go + random_.uniform(0.45, 0.75), hang(Side::Left));
  const bool walks_off = random_.chance(wearer_.habits.walk_off_chance);
  stand(walks_off ? random_.uniform(0.05, 0.3) : let_go - leave + random_.uniform(0.05, 0.4));
  return std::max(let_go, now());
}

}  // namespace kinemap::sim
