// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/landmarks/surface.hpp"

/// How people really trace a rectangle, and what the suit makes of it: reaches at both ends, rounded corners, dwell,
/// overshoot, lift-offs; an arm that errs for seconds, a hand that jitters, a heading drawn away by metal. Shares
/// nothing with the simulator.
namespace kinemap::test {

struct Habit {
  bool upright = false;  ///< a screen; else a table
  double length = 1.4;   ///< u, m
  double width = 0.8;    ///< v, m
  double height = 0.74;  ///< of a table top or of a screen's centre over the floor, m
  double heading = 0.3;  ///< rad
  int sides = 4;         ///< drawn
  bool clockwise = false;
  double start = 0.0;         ///< part of the first side at which a whole contour begins
  double overshoot = 0.0;     ///< beyond the beginning of a whole contour, m
  double speed = 0.25;        ///< m/s
  double rounding = 0.01;     ///< the corner is cut so far from its ends, m
  double dwell_s = 0.2;       ///< at each corner
  double idle_s = 0.2;        ///< the hand hangs before it reaches, and after
  double reach_s = 0.6;       ///< from hanging to the surface, and back
  double lift_every_s = 0.0;  ///< 0: never
  double lift_m = 0.03;
  double arm_m = 0.0;      ///< error of the arm chain at the hand, correlated over 3 s
  double jitter_m = 0.0;   ///< of the hand, correlated over 1.5 s
  double noise_m = 0.002;  ///< white
  double pull_rad = 0.0;   ///< heading drawn so far off, first order within 12 s
  double loss = 0.0;       ///< part of the frames lost, in bursts
  double rate_hz = 120.0;
  std::uint32_t seed = 1;
};

struct HabitTrace {
  std::vector<TracePoint> points;
  std::vector<int> side;  ///< for each point: which leg of the contour (0 …), −1 for a reach
  double contact_begin_s = 0.0, contact_end_s = 0.0;
  std::vector<Eigen::Vector2d> corners;  ///< of the rectangle in its own axes, as they were passed
};

namespace detail {

struct Wander {  // Ornstein-Uhlenbeck
  double sigma, tau;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  bool begun = false;
  Eigen::Vector3d step(double dt, std::mt19937& random) {
    std::normal_distribution<double> n;
    const Eigen::Vector3d w(n(random), n(random), n(random));
    const double a = begun ? std::exp(-dt / tau) : 0.0;
    begun = true;
    return x = a * x + sigma * std::sqrt(1.0 - a * a) * w;
  }
};

inline double minimum_jerk(double x) { return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x); }

struct Sample {
  Eigen::Vector2d p;
  int side;
};

/// The contour in the rectangle's axes, frame by frame.
inline std::vector<Sample> contour(const Habit& h, HabitTrace& out) {
  const double a = h.length / 2, b = h.width / 2;
  std::vector<Eigen::Vector2d> ring{{-a, -b}, {a, -b}, {a, b}, {-a, b}};
  if (h.clockwise) std::reverse(ring.begin(), ring.end());
  std::vector<Eigen::Vector2d> way;
  for (int k = 0; k <= h.sides; ++k) way.push_back(ring[static_cast<std::size_t>(k) % 4]);
  out.corners = way;
  if (h.sides == 4) {
    const Eigen::Vector2d first = way[1] - way[0];
    way.push_back(way[0] + h.start * first + h.overshoot * first.normalized());
    way[0] += h.start * first;
    if (h.start == 0.0 && h.overshoot == 0.0) way.pop_back();
  }
  std::vector<Sample> samples;
  const double step = h.speed / h.rate_hz;
  for (std::size_t k = 1; k < way.size(); ++k) {
    const Eigen::Vector2d d = way[k] - way[k - 1];
    const double length = d.norm(), cut = std::min(h.rounding, length / 4);
    const bool first = k == 1, last = k + 1 == way.size();
    for (double s = first ? 0.0 : cut; s < length - (last ? 0.0 : cut); s += step)
      samples.push_back({way[k - 1] + s * d / length, static_cast<int>(k) - 1});
    if (last) break;
    const Eigen::Vector2d next = (way[k + 1] - way[k]).normalized();
    for (double u = 0.0; u < 1.0; u += std::min(1.0, step / std::max(1e-3, 1.5 * cut)))
      samples.push_back({way[k] - d / length * cut * (1 - u) * (1 - u) + next * cut * u * u,
                         static_cast<int>(k) - (u < 0.5 ? 1 : 0)});
    for (double t = 0.0; t < h.dwell_s; t += 1.0 / h.rate_hz) samples.push_back(samples.back());
  }
  return samples;
}

}  // namespace detail

/// One gesture, as the mapper would see its touching point, thinned as the tracker does.
inline HabitTrace trace_of(const Habit& h) {
  HabitTrace out;
  std::mt19937 random(h.seed);
  const auto contour = detail::contour(h, out);
  const double dt = 1.0 / h.rate_hz;
  const Eigen::AngleAxisd turn(h.heading, Eigen::Vector3d::UnitZ());
  const auto in_room = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    return h.upright ? turn * Eigen::Vector3d(0.0, p.x(), h.height + p.y())
                     : turn * Eigen::Vector3d(p.x(), p.y(), h.height);
  };
  const auto body_at = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    if (h.upright) return turn * Eigen::Vector3d(0.5, 0.6 * p.x(), 0.95);
    const Eigen::Vector2d c(std::clamp(p.x(), -h.length / 2, h.length / 2),
                            std::clamp(p.y(), -h.width / 2, h.width / 2));
    Eigen::Vector2d away = h.length / 2 - std::abs(c.x()) < h.width / 2 - std::abs(c.y())
                               ? Eigen::Vector2d(std::copysign(0.35, c.x()), 0.0)
                               : Eigen::Vector2d(0.0, std::copysign(0.35, c.y()));
    return turn * Eigen::Vector3d(c.x() + away.x(), c.y() + away.y(), 0.95);
  };

  struct Frame {
    Eigen::Vector3d hand, body;
    int side;
  };
  std::vector<Frame> frames;
  const auto idle = [&](const Eigen::Vector3d& hand, const Eigen::Vector3d& body) {
    for (double t = 0.0; t < h.idle_s; t += dt) frames.push_back({hand, body, -1});
  };
  const auto reach = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& body) {
    for (double t = 0.0; t < h.reach_s; t += dt)
      frames.push_back({from + detail::minimum_jerk(t / h.reach_s) * (to - from), body, -1});
  };
  const auto hanging = [&](const Eigen::Vector3d& body, const Eigen::Vector3d& hand) -> Eigen::Vector3d {
    const Eigen::Vector3d ahead = Eigen::Vector3d(hand.x() - body.x(), hand.y() - body.y(), 0.0).normalized();
    return body + 0.22 * Eigen::Vector3d(ahead.y(), -ahead.x(), 0.0) + Eigen::Vector3d(0.0, 0.0, -0.25);
  };
  Eigen::Vector3d body = body_at(contour.front().p);
  const Eigen::Vector3d first = in_room(contour.front().p), last = in_room(contour.back().p);
  idle(hanging(body, first), body);
  reach(hanging(body, first), first, body);
  const Eigen::Vector3d normal = h.upright ? turn * Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const std::size_t begin = frames.size();
  double lifted = -1.0;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const auto& sample : contour) {
    body += (body_at(sample.p) - body) * std::min(1.0, dt / 0.6);
    if (h.lift_every_s > 0.0 && lifted < 0.0 && uniform(random) < dt / h.lift_every_s) lifted = 0.0;
    double lift = 0.0;
    if (lifted >= 0.0) {
      lift = h.lift_m * std::pow(std::sin(M_PI * lifted / 0.4), 2);
      lifted = lifted + dt > 0.4 ? -1.0 : lifted + dt;
    }
    frames.push_back({in_room(sample.p) + lift * normal, body, sample.side});
  }
  const std::size_t end = frames.size();
  reach(last, hanging(body, last), body);
  for (std::size_t i = end; i < frames.size(); ++i)
    frames[i].hand =
        last + detail::minimum_jerk(static_cast<double>(i - end) * dt / h.reach_s) * (hanging(body, last) - last);
  idle(hanging(body, last), body);

  // What the suit says of it.
  detail::Wander arm{h.arm_m, 3.0}, jitter{h.jitter_m, 1.5};
  std::normal_distribution<double> white(0.0, h.noise_m);
  Eigen::Vector3d odom = frames.front().body, kept = Eigen::Vector3d::Constant(HUGE_VAL);
  double kept_s = -1.0, lost_until = -1.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    const Eigen::AngleAxisd pulled(h.pull_rad * (1.0 - std::exp(-t / 12.0)), Eigen::Vector3d::UnitZ());
    if (i > 0) odom += pulled * (frames[i].body - frames[i - 1].body);
    const Eigen::Vector3d error =
        arm.step(dt, random) + jitter.step(dt, random) + Eigen::Vector3d(white(random), white(random), white(random));
    const Eigen::Vector3d p = odom + pulled * (frames[i].hand - frames[i].body) + error;
    if (i == begin) out.contact_begin_s = t;
    if (i + 1 == end) out.contact_end_s = t;
    if (t < lost_until) continue;
    if (h.loss > 0.0 && uniform(random) < dt * h.loss / (0.15 * (1.0 - h.loss))) lost_until = t + 0.3 * uniform(random);
    if ((p - kept).norm() < 0.01 && t - kept_s < 0.1) continue;
    kept = p, kept_s = t;
    out.points.push_back({t, p, odom});
    out.side.push_back(frames[i].side);
  }
  return out;
}

}  // namespace kinemap::test
