// SPDX-License-Identifier: Apache-2.0
#include "tests/core/tracker/postures.hpp"

#include <cmath>

namespace kinemap::test {
namespace {

using Eigen::Vector3d;
using Origin = ArmSpec::Origin;

constexpr double kTau = 2.0 * std::numbers::pi;

}  // namespace

Figure standing() {
  Figure f;
  f.hips = {0, 0, 0.915};
  return f;
}

Figure sitting(const Puppet& puppet, double seat_m) {
  Figure f;
  f.hips = {0, 0, seat_m + 0.09};
  f.hips_exact = true;
  f.pelvis_pitch = -25 * kDegree;
  f.trunk_pitch = -5 * kDegree;
  const double ankle_x = 0.42 * puppet.stature_m() / 1.75;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {ankle_x / (puppet.stature_m() / 1.75), 0.10, 0};
    f.knee[i] = {1, 0.1, 1};
    f.arm[i] = in_lap();
  }
  return f;
}

Figure sitting_leaning(const Puppet& puppet, double seat_m) {
  Figure f = sitting(puppet, seat_m);
  f.pelvis_pitch = 10 * kDegree;
  f.trunk_pitch = 45 * kDegree;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i].x() = 0.24;
    f.arm[i] = typing(0);
  }
  return f;
}

Figure sitting_cross_legged(const Puppet& puppet, double seat_m) {
  Figure f = sitting(puppet, seat_m);
  const double knee_m = (0.412 + 0.096) * puppet.stature_m() / 1.75;
  f.ankle[1] = {0.40, -0.02, (knee_m + 0.02) / (puppet.stature_m() / 1.75)};
  f.knee[1] = {0.5, 1, 0.2};
  return f;
}

Figure sitting_twisted(const Puppet& puppet, double seat_m) {
  Figure f = sitting(puppet, seat_m);
  f.chest_twist = 40 * kDegree;
  return f;
}

Figure lounging(const Puppet& puppet, double seat_m) {
  Figure f = sitting(puppet, seat_m);
  f.pelvis_pitch = -40 * kDegree;
  f.trunk_pitch = -35 * kDegree;
  for (auto& ankle : f.ankle) ankle.x() = 0.55;
  return f;
}

Figure squatting(const Puppet& puppet, double hips_m) {
  Figure f;
  f.hips = {0, 0, hips_m};
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {0.17, 0.14, 0};
    f.arm[i].wrist = {0.45, 0.0, -0.1};
    f.arm[i].hand = {1, 0, 0};
  }
  f.pelvis_pitch = 15 * kDegree;
  return puppet.balanced(f, (0.17 + 0.06) * puppet.stature_m() / 1.75);
}

Figure squatting_on_toes(const Puppet& puppet) {
  Figure f = squatting(puppet, 0.34);
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {0.06, 0.12, 0.09};
    f.foot_pitch[i] = 40 * kDegree;
  }
  return puppet.balanced(f, (0.06 + 0.16) * puppet.stature_m() / 1.75);
}

Figure kneeling_on_heels() {
  Figure f;
  f.hips = {0, 0, 0.22};
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {-0.02, 0.10, -0.04};
    f.foot_pitch[i] = 165 * kDegree;
    f.arm[i] = in_lap();
  }
  return f;
}

Figure kneeling_upright() {
  Figure f = kneeling_on_heels();
  f.hips.z() = 0.47;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i].x() = -0.40;
    f.arm[i] = hanging();
  }
  return f;
}

Figure kneeling_on_one_knee() {
  Figure f = kneeling_upright();
  f.ankle[0] = {0.40, 0.10, 0};
  f.foot_pitch[0] = 0;
  return f;
}

Figure stooping(const Puppet& puppet) {
  Figure f;
  f.hips = {0, 0, 0.89};
  f.pelvis_pitch = 55 * kDegree;
  for (auto& ankle : f.ankle) ankle.x() = 0.18;
  return puppet.balanced(f, 0.22 * puppet.stature_m() / 1.75);
}

Figure perching(const Puppet& puppet, double thigh_rad) {
  Figure f;
  const double thigh = 0.421;
  const double shank = 0.412;
  constexpr double kShank = 8 * kDegree;  // ankle before the knee
  f.hips = {0, 0,
            thigh * std::sin(thigh_rad) + shank * std::cos(kShank) + puppet.ankle_m() * 1.75 / puppet.stature_m()};
  f.pelvis_pitch = -10 * kDegree;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {thigh * std::cos(thigh_rad) + shank * std::sin(kShank), 0.10, 0};
    f.knee[i] = {1, 0.1, 1};
  }
  return f;
}

Figure lying(double surface_m) {
  Figure f;
  f.hips = {0, 0, surface_m + 0.12};
  f.hips_exact = true;
  f.pelvis_pitch = -88 * kDegree;
  f.trunk_pitch = -88 * kDegree;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {0.82, 0.10, surface_m};
    f.foot_pitch[i] = -80 * kDegree;
    f.knee[i] = {0, 0, 1};
  }
  return f;
}

Figure sitting_on_floor() {
  Figure f;
  f.hips = {0, 0, 0.10};
  f.pelvis_pitch = -20 * kDegree;
  for (std::size_t i = 0; i < 2; ++i) {
    f.ankle[i] = {0.80, 0.12, 0};
    f.foot_pitch[i] = -60 * kDegree;
    f.knee[i] = {0, 0, 1};
  }
  return f;
}

Figure leaning_on_wall() {
  Figure f = standing();
  f.hips.z() = 0.88;
  f.trunk_pitch = -8 * kDegree;
  for (auto& ankle : f.ankle) ankle.x() = 0.28;
  return f;
}

Figure walking(double t, double speed_mps, const Eigen::Vector2d& from, double heading) {
  constexpr double kStride = 1.1;
  constexpr double kStance = 0.6;
  Figure f;
  f.heading = heading;
  const double sway = 0.02 * std::sin(kTau * t / kStride);
  const Eigen::Vector2d forward(std::cos(heading), std::sin(heading));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  f.hips.head<2>() = from + speed_mps * t * forward + sway * left;
  f.hips.z() = 0.89 + 0.012 * std::cos(2 * kTau * t / kStride);
  for (std::size_t i = 0; i < 2; ++i) {
    const double cycles = t / kStride + (i == 0 ? 0.0 : 0.5);
    const double phase = cycles - std::floor(cycles);
    // Planted where the hips are in the middle of the stance.
    const auto planted = [&](double k) { return speed_mps * kStride * (k + 0.5 * kStance - (i == 0 ? 0.0 : 0.5)); };
    double ankle = planted(std::floor(cycles));
    double lift = 0.0;
    if (phase > kStance) {
      const double x = (phase - kStance) / (1.0 - kStance);
      ankle += (planted(std::floor(cycles) + 1) - ankle) * x * x * (3 - 2 * x);
      lift = 0.08 * std::pow(std::sin(std::numbers::pi * x), 2);
    }
    f.ankle[i] = {ankle - speed_mps * t, 0.09 + (i == 0 ? -sway : sway), lift};
    f.arm[i].wrist.x() += 0.2 * std::sin(kTau * t / kStride + (i == 0 ? 0.0 : std::numbers::pi));
  }
  return f;
}

Figure jumping(const Puppet& puppet, double t) {
  const double x = 0.5 - 0.5 * std::cos(kTau * t);
  Figure f = squatting(puppet, 0.915 - 0.43 * x);
  for (auto& ankle : f.ankle) ankle.z() = x < 0.1 ? 0.1 - x : 0.0;
  return f;
}

ArmSpec on_hip(const HipStyle& style) {
  ArmSpec arm;
  arm.origin = Origin::Hip;
  arm.hand = style.thumb_forward ? Vector3d(-0.6, -0.45, -0.5) : Vector3d(0.7, -0.35, -0.5);
  arm.wrist = Vector3d(0.0, 0.08, 0.12);
  // The palm covers the crest; a fist or a bent wrist rests with the wrist itself beside it.
  if (!style.fist) arm.wrist -= 0.04 * arm.hand.normalized();
  arm.wrist += style.shift;
  arm.elbow = {-0.5, 1, 0};
  return arm;
}

ArmSpec hanging() { return {}; }

ArmSpec at_ear() { return {Origin::Shoulder, {0.10, -0.03, 0.12}, {-0.1, -0.2, 1}, {0.2, 1, -1}}; }

ArmSpec before_belly() { return {Origin::LevelHip, {0.20, -0.10, 0.26}, {0.1, -1, 0.2}, {-0.2, 1, -0.5}}; }

ArmSpec in_pocket() { return {Origin::Hip, {0.03, 0.07, 0.03}, {0.25, -0.1, -1}, {-1, 0.5, 0}}; }

ArmSpec in_lap() { return {Origin::LevelHip, {0.16, 0.02, 0.11}, {0.75, -0.65, -0.1}, {-0.5, 1, -0.5}}; }

ArmSpec scratching(double t) {
  ArmSpec arm = on_hip();
  arm.wrist += Vector3d(0.02, 0.0, 0.06 * std::sin(kTau * 2.5 * t));
  return arm;
}

ArmSpec waving(double t) {
  return {Origin::Shoulder, {0.2, 0.2 + 0.2 * std::sin(kTau * 1.2 * t), 0.25}, {0, 0.1, 1}, {0, 1, -1}};
}

ArmSpec running_swing(double t) {
  return {Origin::Shoulder, {0.08 + 0.18 * std::sin(kTau * 1.4 * t), 0.04, -0.33}, {1, -0.2, 0.1}, {-1, 0.3, 0}};
}

ArmSpec typing(double t) {
  return {Origin::Shoulder, {0.38, -0.05 + 0.02 * std::sin(kTau * t), -0.28}, {1, -0.2, -0.2}, {-0.5, 1, -1}};
}

ArmSpec drawing(double t) {
  const double side = 4.0 * (t / 8.0 - std::floor(t / 8.0));  // 0–1 top, 1–2 down, 2–3 bottom, 3–4 up
  const double u = side < 1 ? side : side < 2 ? 1.0 : side < 3 ? 3.0 - side : 0.0;
  const double v = side < 1 ? 1.0 : side < 2 ? 2.0 - side : side < 3 ? 0.0 : side - 3.0;
  return {Origin::Shoulder, {0.40, -0.15 + 0.4 * (u - 0.5), -0.1 + 0.3 * (v - 0.5)}, {1, 0, 0.1}, {-0.3, 0.5, -1}};
}

}  // namespace kinemap::test
