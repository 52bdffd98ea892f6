// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/contour.hpp"

namespace kinemap::sim {

namespace {

struct Node {
  Vec3 p;
  Vec3 outward;
  double speed = 0.0;    ///< m/s
  double pause_s = 0.0;  ///< on arrival
};

/// Points every few millimetres, corners rounded; speed falls towards each corner.
std::vector<Node> nodes_of(const Contour& contour, const TracingHabit& habit, Random& random) {
  constexpr double kStep = 0.004, kSlowZone = 0.05;
  std::vector<Node> nodes;
  const std::size_t edges = contour.vertices.size() - 1;
  double cut_before = 0.0;
  for (std::size_t e = 0; e < edges; ++e) {
    const Vec3 &a = contour.vertices[e], &b = contour.vertices[e + 1];
    const double length = (b - a).norm();
    const Vec3 d = (b - a) / length;
    const bool last = e + 1 == edges;
    const double cut = last ? 0.0 : std::min(random.uniform(0.0, 0.02 + 0.02 * habit.sloppiness), length / 4);
    const double edge_speed = habit.speed * random.uniform(0.85, 1.15);
    for (double s = cut_before; s < length - cut; s += kStep) {
      const double to_corner = std::min(e == 0 ? 1e9 : s, last ? 1e9 : length - s);
      nodes.push_back({a + d * s, contour.outward[e], edge_speed * std::clamp(to_corner / kSlowZone, 0.35, 1.0), 0.0});
    }
    if (last) break;
    const Vec3 next = (contour.vertices[e + 2] - b).normalized();
    nodes.back().pause_s = random.chance(0.6) ? random.uniform(0.0, 0.6) : 0.0;
    for (double u = 0.1; u < 1.0 && cut > 2 * kStep; u += 0.1) {  // a quadratic curve past the corner
      const Vec3 p = b - d * cut * (1 - u) * (1 - u) + next * cut * u * u;
      nodes.push_back(
          {p, (contour.outward[e] * (1 - u) + contour.outward[e + 1] * u).normalized(), edge_speed * 0.4, 0.0});
    }
    cut_before = cut;
  }
  nodes.push_back({contour.vertices.back(), contour.outward.back(), habit.speed, 0.0});
  return nodes;
}

/// Adds what a hand does beside following the line.
void disturb(std::vector<ContourSample>& samples, const Contour& contour, const TracingHabit& habit, double rate_hz,
             Random& random) {
  const double dt = 1.0 / rate_hz, scale = 0.5 + habit.sloppiness;
  Wander across(0.0025 * scale, 0.7, random), off(0.0015 * scale, 0.5, random);
  std::vector<Vec3> offsets(samples.size(), Vec3::Zero());
  const Vec3 up = Vec3::UnitZ();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 tangent = (samples[std::min(i + 1, samples.size() - 1)].p - samples[i > 0 ? i - 1 : 0].p);
    Vec3 sideways = contour.surface.cross(tangent.norm() > 1e-7 ? tangent.normalized() : up);
    const double a = across.step(dt, random), o = off.step(dt, random);
    offsets[i] = sideways * a + contour.surface * std::abs(o);
  }
  const double lift_rate = 0.16 * habit.sloppiness;  // lift-offs per second
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!random.chance(lift_rate * dt)) continue;
    const auto length = static_cast<std::size_t>(random.uniform(0.2, 0.5) * rate_hz);
    const double height = random.uniform(0.006, 0.02);
    for (std::size_t k = 0; k < length && i + k < samples.size(); ++k) {
      const double arc = std::sin(kPi * static_cast<double>(k) / static_cast<double>(length));
      offsets[i + k] += contour.surface * height * arc * arc;
    }
    i += length;
  }
  smooth_samples(offsets, 0.02 * rate_hz);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].p += offsets[i];
}

}  // namespace

std::vector<ContourSample> run_along(const Contour& contour, const TracingHabit& habit, double rate_hz,
                                     Random& random) {
  const auto nodes = nodes_of(contour, habit, random);
  std::vector<ContourSample> samples;
  const double dt = 1.0 / rate_hz;
  double left = 0.0;  // time left of this frame when a node is reached
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    for (double t = 0.0; t < nodes[i].pause_s; t += dt) samples.push_back({nodes[i].p, nodes[i].outward});
    const double duration = (nodes[i + 1].p - nodes[i].p).norm() / nodes[i].speed;
    double t = left;
    for (; t < duration; t += dt) {
      samples.push_back({nodes[i].p + (nodes[i + 1].p - nodes[i].p) * (t / duration), nodes[i].outward});
    }
    left = t - duration;
  }
  samples.push_back({nodes.back().p, nodes.back().outward});
  std::vector<Vec3> points;
  for (const auto& sample : samples) points.push_back(sample.p);
  smooth_samples(points, 0.03 * rate_hz);  // no jerk at speed changes; bends corners by less than a centimetre
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].p = points[i];
  disturb(samples, contour, habit, rate_hz, random);
  return samples;
}

}  // namespace kinemap::sim
