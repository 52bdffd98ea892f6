// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/gait.hpp"

namespace kinemap::sim {

namespace {

constexpr double kToeOut = 0.11;      ///< rad
constexpr double kHeelRise_s = 0.20;  ///< before the foot lifts
constexpr double kSettled_s = 0.5;    ///< standing this long, feet are put right

class Stepper {
 public:
  Stepper(const Score& score, const Body& body) : score_(score), dt_(1.0 / score.rate_hz), n_(score.frames()) {
    hip_ = std::abs(body.offset[kLeftUpperLeg].y()) + 0.012;
    for (int f = 0; f < 2; ++f) {
      gait_.plants[static_cast<std::size_t>(f)].push_back({0, n_, nominal(f, 0), foot_heading(f, 0), 0.0});
    }
  }

  Gait run() {
    long still_frames = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      if (i < busy_until_) continue;
      const double ahead = speed(i + frames(0.3));
      still_frames = ahead < 0.02 ? still_frames + 1 : 0;
      const double threshold = static_cast<double>(still_frames) * dt_ > kSettled_s ? 0.045 : 0.085;
      consider(i, threshold);
    }
    return std::move(gait_);
  }

 private:
  [[nodiscard]] std::size_t frames(double seconds) const {
    return static_cast<std::size_t>(std::lround(seconds / dt_));
  }
  [[nodiscard]] std::size_t cut(std::size_t i) const { return std::min(i, n_ - 1); }
  [[nodiscard]] double side(int foot) const { return foot == 0 ? -1.0 : 1.0; }

  /// Ground speed, with turning counted as the feet's way round the body.
  [[nodiscard]] double speed(std::size_t i) const {
    const std::size_t a = cut(i), b = cut(i + frames(0.2));
    if (b <= a) return 0.0;
    const double s = static_cast<double>(b - a) * dt_;
    return ((score_.ground[b] - score_.ground[a]).norm() + 0.15 * std::abs(score_.heading[b] - score_.heading[a])) / s;
  }
  [[nodiscard]] Vec2 nominal(int foot, std::size_t i) const {
    i = cut(i);
    return score_.ground[i] + left_of(direction(score_.heading[i])) * side(foot) * hip_;
  }
  [[nodiscard]] double foot_heading(int foot, std::size_t i) const {
    return score_.heading[cut(i)] + side(foot) * kToeOut;
  }

  /// Starts a swing at frame i if a foot is far enough from its place.
  void consider(std::size_t i, double threshold) {
    const double v = std::max(speed(i), speed(i + frames(0.3)));
    const double swing_s = std::clamp(0.62 - 0.22 * v, 0.36, 0.60), support_s = std::clamp(0.17 - 0.07 * v, 0.08, 0.2);
    const std::size_t land = i + frames(swing_s);
    const std::size_t wanted = land + frames(0.5 * swing_s + support_s);
    if (land + 2 >= n_) return;
    int foot = -1;
    double worst = threshold;
    for (int f = 0; f < 2; ++f) {
      const Plant& plant = gait_.plants[static_cast<std::size_t>(f)].back();
      double error =
          (nominal(f, wanted) - plant.ankle).norm() + 0.2 * std::abs(foot_heading(f, wanted) - plant.heading);
      if (f == last_) error *= 0.75;  // feet alternate
      if (error > worst) worst = error, foot = f;
    }
    if (foot < 0) return;
    step(foot, i, land, wanted);
    busy_until_ = land + frames(support_s);
    last_ = foot;
  }

  void step(int foot, std::size_t lift, std::size_t land, std::size_t wanted) {
    auto& plants = gait_.plants[static_cast<std::size_t>(foot)];
    Plant& from = plants.back();
    Plant to{land, n_, nominal(foot, wanted), foot_heading(foot, wanted), 0.0};
    // Never across the other foot.
    const Plant& other = gait_.plants[static_cast<std::size_t>(1 - foot)].back();
    const Vec2 lateral_axis = left_of(direction(score_.heading[cut(wanted)])) * side(foot);
    const double apart = (to.ankle - other.ankle).dot(lateral_axis);
    if (std::abs((to.ankle - other.ankle).dot(direction(score_.heading[cut(wanted)]))) < 0.25 && apart < 0.11) {
      to.ankle += lateral_axis * (0.11 - apart);
    }
    const double forward = (to.ankle - from.ankle).dot(direction(from.heading));
    from.lift = lift;
    from.roll_off = 0.62 * std::clamp((forward - 0.15) / 0.9, 0.0, 1.0);
    plants.push_back(to);
  }

  const Score& score_;
  double dt_;
  std::size_t n_;
  double hip_ = 0.1;
  Gait gait_;
  std::size_t busy_until_ = 0;
  int last_ = -1;
};

Vec2 ball_of(const Plant& plant, double ankle_to_ball) {
  return plant.ankle + direction(plant.heading) * ankle_to_ball;
}

/// Fills the per-frame states of one foot from its plants.
std::vector<FootState> states(const std::vector<Plant>& plants, const Body& body, double rate_hz, std::size_t n) {
  std::vector<FootState> out(n);
  const double reach = body.offset[kRightToe].x(), low = body.ball_height;
  for (std::size_t k = 0; k < plants.size(); ++k) {
    const Plant& plant = plants[k];
    const Vec2 ball = ball_of(plant, reach);
    const double rise_from = static_cast<double>(plant.lift) - kHeelRise_s * rate_hz;
    for (std::size_t i = plant.land; i < std::min(plant.lift, n); ++i) {
      const double u = (static_cast<double>(i) - rise_from) / (kHeelRise_s * rate_hz);
      out[i] = {lift(ball, low), plant.heading, plant.roll_off * smooth_step(u), true, k};
    }
    if (k + 1 == plants.size()) break;
    const Plant& next = plants[k + 1];
    const Vec2 target = ball_of(next, reach);
    const double bump = 0.02 + 0.05 * std::clamp((target - ball).norm() / 0.8, 0.0, 1.0);
    for (std::size_t i = plant.lift; i < std::min(next.land, n); ++i) {
      const double u = static_cast<double>(i - plant.lift) / static_cast<double>(next.land - plant.lift);
      const double s = smooth_step(u), arc = std::sin(kPi * u);
      out[i] = {lift(ball + (target - ball) * s, low + bump * arc * arc),
                plant.heading + (next.heading - plant.heading) * s, plant.roll_off * (1.0 - smooth_step(1.6 * u)),
                false, k};
    }
  }
  return out;
}

}  // namespace

Gait make_gait(const Score& score, const Body& body) {
  Gait gait = Stepper(score, body).run();
  for (std::size_t f = 0; f < 2; ++f) gait.feet[f] = states(gait.plants[f], body, score.rate_hz, score.frames());
  return gait;
}

}  // namespace kinemap::sim
