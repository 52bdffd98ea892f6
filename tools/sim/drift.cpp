// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/drift.hpp"

namespace kinemap::sim {

namespace {

/// Times at which a foot lands, both feet, in order.
std::vector<std::size_t> landings(const Gait& gait) {
  std::vector<std::size_t> out;
  for (const auto& plants : gait.plants) {
    for (std::size_t k = 1; k < plants.size(); ++k) out.push_back(plants[k].land);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Random walk in steps: the increment of the way between two landings comes smoothly with the later step. `walked` at
/// each frame, m.
template <class T, class Draw>
std::vector<T> stepwise(const std::vector<std::size_t>& landings, const std::vector<double>& walked,
                        std::size_t step_frames, const T& zero, Draw draw) {
  std::vector<T> out(walked.size(), zero);
  T value = zero;
  std::size_t from = 0;
  for (std::size_t k = 0; k <= landings.size(); ++k) {
    const std::size_t to = k < landings.size() ? landings[k] : walked.size();
    const T increment =
        k == 0 || k == landings.size() ? zero : T(draw(walked[std::min(to, walked.size() - 1)] - walked[from]));
    const double duration = static_cast<double>(std::min(step_frames, std::max<std::size_t>(1, to - from)));
    for (std::size_t i = from; i < to; ++i) {
      out[i] = value + increment * smooth_step(1.0 - static_cast<double>(to - i) / duration);
    }
    value += increment;
    from = to;
  }
  return out;
}

}  // namespace

DriftColumn column_of(Severity severity) {
  // Order as declared. Percent, centimetres and degrees of the source table; the chances of a false step and the loss
  // bursts of the outer columns are not in it and follow the default column.
  switch (severity) {
    case Severity::Good:
      return {0.01, 0.01, 0.3, 0.3, 0, 10, 30, 0.003, 0.005, 0.02, 0.5, 1, 0.005, 0.01, 0.005, 0.002, 0.01, 0.0, 1};
    case Severity::Bad:
      return {0.04, 0.04, 10, 5, 35, 10, 10, 0.02, 0.03, 0.02, 2, 6, 0.03, 0.04, 0.02, 0.008, 0.04, 0.30, 4};
    case Severity::Default:
      break;
  }
  return {0.022, 0.02, 3, 2, 20, 10, 30, 0.01, 0.01, 0.02, 1, 3, 0.015, 0.02, 0.01, 0.004, 0.02, 0.01, 6};
}

std::vector<MagneticPatch> draw_patches(const Building& building, const DriftColumn& column, Random& random) {
  std::vector<MagneticPatch> patches;
  if (column.magnetic_deg <= 0.0) return patches;
  const auto add = [&](const Footprint& metal) {
    const double tau = random.uniform(column.magnetic_tau_low_s, column.magnetic_tau_high_s);
    patches.push_back({metal, random.uniform(0.3, 0.5), radians(column.magnetic_deg) * random.sign(), tau});
  };
  for (const auto& table : building.tables) add(table.top);
  for (const auto& screen : building.screens) {
    if (screen.big) add({screen.centre.head<2>(), screen.heading, {0.03, screen.width / 2}});
  }
  return patches;
}

double MagneticPull::step(const Vec2& at, const std::vector<MagneticPatch>& patches, double dt_s) {
  double target = 0.0, nearest = 1.0;
  for (const auto& patch : patches) {
    const double d = patch.metal.distance(at) / patch.radius;
    if (d < nearest) nearest = d, target = patch.target, tau_s_ = patch.tau_s;
  }
  value_ += (target - value_) * (1.0 - std::exp(-dt_s / tau_s_));
  return value_;
}

Slip make_slip(const std::vector<Vec2>& pelvis, const Score& score, const Gait& gait, const DriftColumn& column,
               const std::vector<MagneticPatch>& patches, Random& random) {
  const std::size_t n = pelvis.size();
  const double dt = 1.0 / score.rate_hz;
  std::vector<double> walked(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) walked[i] = walked[i - 1] + (score.ground[i] - score.ground[i - 1]).norm();

  Slip slip;
  slip.heading.resize(n);
  slip.magnetic.resize(n, 0.0);
  const double bias = radians(column.heading_bias_deg_min) / 60.0 * random.sign();
  const double walk = radians(column.heading_walk_deg_sqrt_min) / std::sqrt(60.0);
  MagneticPull pull;
  double wandering = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) slip.magnetic[i] = pull.step(pelvis[i], patches, dt);
    slip.heading[i] = bias * static_cast<double>(i) * dt + wandering + slip.magnetic[i];
    wandering += random.normal(walk * std::sqrt(dt));
  }

  const auto steps = landings(gait);
  const auto step_frames = static_cast<std::size_t>(0.5 * score.rate_hz);
  const auto level = stepwise<Vec2>(steps, walked, step_frames, Vec2(0, 0), [&](double d) {
    const double sigma = column.walk_m_per_sqrt_m * std::sqrt(std::max(0.0, d));
    const double x = random.normal(sigma), y = random.normal(sigma);
    return Vec2(x, y);
  });
  slip.height = stepwise<double>(steps, walked, step_frames, 0.0, [&](double d) {
    const double false_step = random.chance(column.false_step_chance) ? column.false_step_m * random.sign() : 0.0;
    return random.normal(column.vertical_m_per_sqrt_m * std::sqrt(std::max(0.0, d))) + false_step;
  });
  const double scale = 1.0 + random.bounded_normal(column.step_scale, 2.5);
  slip.pelvis.resize(n);
  Vec2 at = pelvis.empty() ? Vec2(0, 0) : pelvis.front();
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const Vec2 d = (pelvis[i] - pelvis[i - 1]) * scale;
      const double h = 0.5 * (slip.heading[i] + slip.heading[i - 1]);
      at += Vec2(std::cos(h) * d.x() - std::sin(h) * d.y(), std::sin(h) * d.x() + std::cos(h) * d.y());
    }
    slip.pelvis[i] = at + level[i];
  }
  return slip;
}

}  // namespace kinemap::sim
