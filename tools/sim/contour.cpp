// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/contour.hpp"

namespace kinemap::sim {

namespace {

constexpr double kStep = 0.004, kSlowZone = 0.05;  // m

struct Node {
  Vec3 p;
  Vec3 outward;
  double speed = 0.0;    ///< m/s
  double pause_s = 0.0;  ///< on arrival
};

/// A speed that varies along an edge: some hurry, some slow down.
class Pace {
 public:
  Pace(double length, double spread, Random& random) : factors_(2 + static_cast<std::size_t>(length / kPiece)) {
    for (auto& f : factors_) f = std::max(0.3, 1.0 + random.bounded_normal(spread, 2.0));
  }
  [[nodiscard]] double at(double s) const {
    const double u = std::clamp(s / kPiece, 0.0, static_cast<double>(factors_.size()) - 1.001);
    const auto k = static_cast<std::size_t>(u);
    return factors_[k] + (factors_[k + 1] - factors_[k]) * (u - std::floor(u));
  }

 private:
  static constexpr double kPiece = 0.2;
  std::vector<double> factors_;
};

/// Points every few millimetres, with what happens at the corners; speed falls towards each of them.
class Route {
 public:
  Route(const Contour& contour, const Habits& habits, double speed, const HandRoom& has_room, Random& random)
      : contour_(contour), habits_(habits), speed_(speed), has_room_(has_room), random_(random) {}

  std::vector<Node> nodes() {
    const std::size_t edges = contour_.vertices.size() - 1;
    double from = 0.0;
    for (std::size_t e = 0; e < edges; ++e) {
      const bool last = e + 1 == edges;
      const double length = (contour_.vertices[e + 1] - contour_.vertices[e]).norm();
      const bool past = !last && goes_past(e);
      const double cut = last || past ? 0.0 : std::min(random_.uniform(0.0, habits_.corner_round_m), length / 5);
      along(e, from, length - cut, length, last);
      if (last) break;
      if (random_.chance(habits_.dwell_chance)) nodes_.back().pause_s += random_.uniform(0.0, habits_.dwell_s);
      from = past ? round_past(e) : round_short(e, cut);
    }
    nodes_.push_back({contour_.vertices.back(), contour_.outward.back(), speed_, 0.0});
    for (Node* end : {&nodes_.front(), &nodes_.back()})
      if (random_.chance(habits_.dwell_chance)) end->pause_s = random_.uniform(0.0, habits_.dwell_s);
    return std::move(nodes_);
  }

 private:
  [[nodiscard]] Vec3 direction_of(std::size_t e) const {
    return (contour_.vertices[e + 1] - contour_.vertices[e]).normalized();
  }

  void along(std::size_t e, double from, double to, double length, bool last) {
    const Vec3 d = direction_of(e);
    const double edge_speed = speed_ * random_.uniform(0.85, 1.15);
    const Pace pace(length, habits_.pace_spread, random_);
    for (double s = from; s < to; s += kStep) {
      const double to_corner = std::min(e == 0 ? 1e9 : s, last ? 1e9 : length - s);
      const double slow = std::clamp(to_corner / kSlowZone, 0.35, 1.0);
      const double pause =
          random_.chance(habits_.pause_per_m * kStep) ? random_.uniform(0.3, 1.0) * habits_.pause_s : 0;
      nodes_.push_back({contour_.vertices[e] + d * s, contour_.outward[e], edge_speed * slow * pace.at(s), pause});
    }
  }

  /// A quadratic curve past the corner after edge `e`. Both return where on the next edge the hand goes on, m.
  double round_short(std::size_t e, double cut) {
    const Vec3& b = contour_.vertices[e + 1];
    const Vec3 d = direction_of(e), next = direction_of(e + 1);
    for (double u = 0.1; u < 1.0 && cut > 2 * kStep; u += 0.1)
      turn(e, u, b - d * cut * (1 - u) * (1 - u) + next * cut * u * u);
    return cut;
  }

  [[nodiscard]] bool goes_past(std::size_t e) {
    return random_.chance(habits_.overshoot_chance) &&
           has_room_(contour_.vertices[e + 1] + direction_of(e) * (habits_.overshoot_m + 0.04));
  }
  double round_past(std::size_t e) {
    const Vec3& b = contour_.vertices[e + 1];
    const Vec3 d = direction_of(e), next = direction_of(e + 1);
    const double past = random_.uniform(0.4, 1.0) * habits_.overshoot_m, on = random_.uniform(0.0, 0.6) * past;
    for (double s = kStep; s < past; s += kStep) turn(e, 0.0, b + d * s);
    for (double u = 0.1; u < 1.0; u += 0.1) turn(e, u, b + d * past * (1 - u) + next * on * u);
    return on;
  }
  void turn(std::size_t e, double u, const Vec3& p) {
    const Vec3 outward = (contour_.outward[e] * (1 - u) + contour_.outward[e + 1] * u).normalized();
    nodes_.push_back({p, outward, 0.4 * speed_, 0.0});
  }

  const Contour& contour_;
  const Habits& habits_;
  double speed_;
  const HandRoom& has_room_;
  Random& random_;
  std::vector<Node> nodes_;
};

/// The route over time.
std::vector<ContourSample> timed(const std::vector<Node>& nodes, double dt) {
  std::vector<ContourSample> samples;
  double left = 0.0;  // time left of this frame when a node is reached
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (double t = 0.0; t < nodes[i].pause_s; t += dt) samples.push_back({nodes[i].p, nodes[i].outward});
    if (i + 1 == nodes.size()) break;
    const double duration = (nodes[i + 1].p - nodes[i].p).norm() / nodes[i].speed;
    double t = left;
    for (; t < duration; t += dt)
      samples.push_back({nodes[i].p + (nodes[i + 1].p - nodes[i].p) * (t / duration), nodes[i].outward});
    left = t - duration;
  }
  samples.push_back({nodes.back().p, nodes.back().outward});
  return samples;
}

/// Adds what a hand does beside following the line: trembles and grazes.
void disturb(std::vector<ContourSample>& samples, const Vec3& surface, const Habits& habits, double rate_hz,
             Random& random) {
  const double dt = 1.0 / rate_hz;
  Wander across(0.0025 * habits.unrest, 0.7, random), off(0.0015 * habits.unrest, 0.5, random);
  std::vector<Vec3> offsets(samples.size(), Vec3::Zero());
  const Vec3 up = Vec3::UnitZ();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 tangent = (samples[std::min(i + 1, samples.size() - 1)].p - samples[i > 0 ? i - 1 : 0].p);
    const Vec3 sideways = surface.cross(tangent.norm() > 1e-7 ? tangent.normalized() : up);
    const double a = across.step(dt, random), o = off.step(dt, random);
    offsets[i] = sideways * a + surface * std::abs(o);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!random.chance(habits.graze_per_s * dt)) continue;
    const auto length = static_cast<std::size_t>(random.uniform(0.2, 0.5) * rate_hz);
    const double height = random.uniform(0.006, 0.02);
    for (std::size_t k = 0; k < length && i + k < samples.size(); ++k) {
      const double arc = std::sin(kPi * static_cast<double>(k) / static_cast<double>(length));
      offsets[i + k] += surface * height * arc * arc;
    }
    i += length;
  }
  smooth_samples(offsets, 0.02 * rate_hz);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].p += offsets[i];
}

}  // namespace

void lift_off(std::vector<ContourSample>& samples, const Vec3& surface, const std::vector<Vec3>& keep,
              const Habits& habits, double rate_hz, Random& random) {
  constexpr double kKeep = 0.06;  // m
  const auto near_kept = [&](const Vec3& p) {
    return std::any_of(keep.begin(), keep.end(), [&](const Vec3& k) { return (p - k).norm() < kKeep; });
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!random.chance(habits.lift_per_s / rate_hz)) continue;
    const auto length = static_cast<std::size_t>(random.uniform(0.3, 1.0) * rate_hz);
    const double height = random.uniform(0.4, 1.0) * habits.lift_m;
    bool kept = i + length >= samples.size();
    for (std::size_t k = 0; k <= length && !kept; ++k) kept = near_kept(samples[i + k].p);
    if (kept) continue;
    for (std::size_t k = 0; k <= length; ++k) {
      const double u = static_cast<double>(k) / static_cast<double>(length);
      samples[i + k].p += surface * height * smooth_step(4.0 * u) * smooth_step(4.0 * (1.0 - u));
      samples[i + k].lifted = true;
    }
    i += length;
  }
}

std::vector<ContourSample> run_along(const Contour& contour, const Habits& habits, double speed, double rate_hz,
                                     const HandRoom& has_room, Random& random) {
  auto samples = timed(Route(contour, habits, speed, has_room, random).nodes(), 1.0 / rate_hz);
  std::vector<Vec3> points;
  for (const auto& sample : samples) points.push_back(sample.p);
  smooth_samples(points, 0.03 * rate_hz);  // no jerk at speed changes; bends corners by less than a centimetre
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].p = points[i];
  disturb(samples, contour.surface, habits, rate_hz, random);
  lift_off(samples, contour.surface, contour.vertices, habits, rate_hz, random);
  return samples;
}

}  // namespace kinemap::sim
