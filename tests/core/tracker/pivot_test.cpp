// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/pivot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/tracker/traces.hpp"

namespace kinemap {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kRate = 60.0;

/// What a suit does to an arm (the columns of the reference table): joint angles of shoulder, elbow and wrist,
/// correlated over 3 s; jitter of the hand, correlated over 1.5 s; a pelvis that slips. Each number is that of one
/// axis.
struct Noise {
  double joint_rad, jitter_m, white_m, slip_m_per_sqrt_s;
};
constexpr Noise kGood{1.0 * kRadPerDeg / std::numbers::sqrt3, 0.01 / std::numbers::sqrt3, 0.001, 0.001};
constexpr Noise kDefault{3.0 * kRadPerDeg / std::numbers::sqrt3, 0.02 / std::numbers::sqrt3, 0.002, 0.003};
constexpr Noise kBad{6.0 * kRadPerDeg / std::numbers::sqrt3, 0.04 / std::numbers::sqrt3, 0.004, 0.006};

/// First-order process with a standing deviation, in three axes.
class Slow {
 public:
  Slow(double sigma, double tau_s, std::mt19937& random) : sigma_(sigma), tau_s_(tau_s), random_(random) {
    value_ = sigma_ * draw();
  }
  const Vector3d& step() {
    const double keep = std::exp(-1.0 / (kRate * tau_s_));
    value_ = keep * value_ + sigma_ * std::sqrt(1.0 - keep * keep) * draw();
    return value_;
  }

 private:
  Vector3d draw() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  double sigma_, tau_s_;
  std::mt19937& random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  Vector3d value_;
};

Quaterniond turn(const Vector3d& v) {
  return v.norm() < 1e-12 ? Quaterniond::Identity() : Quaterniond(AngleAxisd(v.norm(), v.normalized()));
}

/// The hand as a suit reports it. `hand(t)` is the true pose of a wearer whose shoulder is at (0, −0.2, 1.4 m of 1.75).
std::vector<HandSample> record(const std::function<Pose(double)>& hand, double duration_s, double stature_m,
                               const Noise& noise, std::uint32_t seed) {
  std::mt19937 random(seed);
  Slow shoulder(noise.joint_rad, 3.0, random), elbow(noise.joint_rad, 3.0, random), wrist(noise.joint_rad, 3.0, random);
  Slow jitter(noise.jitter_m, 1.5, random);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Vector3d p_shoulder(0.0, -0.11 * stature_m, 0.81 * stature_m);
  Vector3d slip = Vector3d::Zero();
  std::vector<HandSample> out;
  for (int i = 0; i < static_cast<int>(duration_s * kRate); ++i) {
    const double t = i / kRate;
    const Pose truth = hand(t);
    const Vector3d p_elbow = 0.45 * p_shoulder + 0.55 * truth.p - Vector3d(0.0, 0.0, 0.08);
    const Vector3d a = shoulder.step(), b = elbow.step(), c = wrist.step();
    for (int k = 0; k < 3; ++k) slip[k] += noise.slip_m_per_sqrt_s / std::sqrt(kRate) * normal(random);
    Vector3d white(normal(random), normal(random), normal(random));
    Pose seen;
    seen.p = truth.p + a.cross(p_elbow - p_shoulder) + (a + b).cross(truth.p - p_elbow) + jitter.step() +
             noise.white_m * white + slip;
    seen.q = turn(a + b + c) * truth.q;
    // Thinned as a trace is: by 1 cm or 0.1 s.
    if (out.empty() || (seen.p - out.back().T_odom_hand.p).norm() > 0.01 || t - out.back().time_s >= 0.1)
      out.push_back({t, seen});
  }
  return out;
}

/// The hand goes to the spot for 1 s, turns about it for `duration_s` by up to ±`swing` about two axes (or one), and
/// back.
struct Gesture {
  Vector3d p_hand{0.0, -0.18, -0.01};
  double swing = 35.0 * kRadPerDeg;
  bool both_axes = true;
  double duration_s = 9.0;
};
std::function<Pose(double)> pivot_motion(const Gesture& g, double stature_m) {
  return [g, stature_m](double t) {
    const Vector3d spot(0.45, -0.15, 0.55 * stature_m);
    const double s = std::clamp(t - 1.0, 0.0, g.duration_s);
    const Quaterniond forward(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()));  // fingers ahead
    const Quaterniond yaw(AngleAxisd(g.swing * std::sin(2.0 * std::numbers::pi * s / 4.5), Vector3d::UnitZ()));
    const double pitch = g.both_axes ? g.swing * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * s / 9.0)) : 0.3;
    Pose out;
    out.q = yaw * AngleAxisd(pitch, Vector3d::UnitY()) * forward;
    out.p = spot - out.q * g.p_hand;
    const double away = std::max({0.0, 1.0 - t, t - 1.0 - g.duration_s});
    out.p += away * Vector3d(-0.3, -0.1, -0.3);
    return out;
  };
}

/// The finger tip goes round a rectangle at 0.3 m/s, the hand yawing with the arm.
std::function<Pose(double)> drawing_motion(double width, double height, bool level) {
  return [=](double t) {
    double s = std::fmod(0.3 * t, 2.0 * (width + height));
    double u = 0.0, v = 0.0;
    if (s < width)
      u = s;
    else if ((s -= width) < height)
      u = width, v = s;
    else if ((s -= height) < width)
      u = width - s, v = height;
    else
      v = height - (s - width);
    const Vector3d tip = level ? Vector3d(0.35 + v, u - 0.5 * width, 0.75) : Vector3d(0.55, u - 0.5 * width, 1.0 + v);
    Pose out;
    out.q = AngleAxisd(std::atan2(tip.y() + 0.2, tip.x()) + 0.5 * std::numbers::pi, Vector3d::UnitZ()) *
            AngleAxisd(0.4 * v, Vector3d::UnitX());
    out.p = tip - out.q * Vector3d(0.0, -0.18, 0.0);
    return out;
  };
}

std::optional<Pivot> find(const std::vector<HandSample>& samples) { return find_pivot(samples, {}); }

struct Score {
  int found = 0, all = 0;
  double squares = 0.0;     ///< of the error along the hand, m²
  double normalised = 0.0;  ///< squared, over the covariance
  int within_one = 0;
};
Score score(const Noise& noise) {
  Score out;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Gesture gesture;
    const double stature = 1.55 + 0.4 * (seed % 9) / 8.0;
    gesture.p_hand = Vector3d(0.0, -(seed % 4 == 0 ? 0.0525 : 0.105) * stature, -0.01);
    const auto pivot = find(record(pivot_motion(gesture, stature), gesture.duration_s + 2.0, stature, noise, seed));
    ++out.all;
    if (!pivot) continue;
    ++out.found;
    const double error = pivot->p_hand.y() - gesture.p_hand.y();
    out.squares += error * error;
    out.normalised += error * error / pivot->covariance(1, 1);
    out.within_one += error * error < pivot->covariance(1, 1);
  }
  return out;
}

TEST(Pivot, IsFoundAndItsUncertaintyIsTrue) {
  const struct {
    Noise noise;
    double rms_m;
    double found;
  } cases[] = {{kGood, 0.01, 0.95}, {kDefault, 0.022, 0.9}, {kBad, 0.04, 0.0}};
  for (const auto& c : cases) {
    const Score s = score(c.noise);
    EXPECT_GE(s.found, c.found * s.all) << c.rms_m;
    if (s.found == 0) continue;
    EXPECT_LT(std::sqrt(s.squares / s.found), c.rms_m);
    EXPECT_LT(std::sqrt(s.normalised / s.found), 1.5) << "over-confident at " << c.rms_m;
  }
}

TEST(Pivot, WithoutNoiseItIsExact) {
  const Gesture gesture;
  const auto pivot = find(record(pivot_motion(gesture, 1.75), 11.0, 1.75, {0, 0, 0, 0}, 1));
  ASSERT_TRUE(pivot);
  EXPECT_LT((pivot->p_hand - gesture.p_hand).norm(), 2e-3);
  EXPECT_NEAR(pivot->begin_s, 1.0, 0.5);
  EXPECT_NEAR(pivot->end_s, 10.0, 0.5);
}

TEST(Pivot, OneAxisLeavesThePointOpenAlongIt) {
  Gesture gesture;
  gesture.both_axes = false;
  const auto pivot = find(record(pivot_motion(gesture, 1.75), 11.0, 1.75, kGood, 3));
  ASSERT_TRUE(pivot);
  const Vector3d error = pivot->p_hand - gesture.p_hand;
  EXPECT_LT(error.dot(pivot->covariance.inverse() * error), 11.34) << "99 % of three numbers";
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(pivot->covariance);
  EXPECT_GT(std::sqrt(axes.eigenvalues()[2]), 0.1);
  EXPECT_LT(std::sqrt(axes.eigenvalues()[1]), 0.03);
}

TEST(Pivot, AHandThatHardlyTurnsSaysNothing) {
  Gesture gesture;
  gesture.swing = 8.0 * kRadPerDeg;
  EXPECT_FALSE(find(record(pivot_motion(gesture, 1.75), 11.0, 1.75, kDefault, 3)));
}

TEST(Pivot, ADrawingIsNone) {
  for (const Noise& noise : {kGood, kDefault, kBad})
    for (std::uint32_t seed = 1; seed <= 8; ++seed)
      for (const bool level : {true, false})
        for (const double width : {0.4, 0.6, 1.2}) {
          const double height = 0.6 * width;
          const double duration = 2.0 * (width + height) / 0.3;
          EXPECT_FALSE(find(record(drawing_motion(width, height, level), duration, 1.75, noise, seed)))
              << width << " level " << level << " seed " << seed;
        }
}

TEST(Pivot, TurningAboutTheElbowIsNone) {
  const auto waving = [](double t) {
    const Vector3d elbow(0.2, -0.25, 1.1);
    Pose out;
    out.q =
        AngleAxisd(0.6 * std::sin(2.0 * t), Vector3d::UnitX()) * AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ());
    out.p = elbow + out.q * Vector3d(0.0, -0.26, 0.0);
    return out;
  };
  EXPECT_FALSE(find(record(waving, 8.0, 1.75, kGood, 1)));
}

TEST(Pivot, ComesOutOfTheGestureInsteadOfATrace) {
  for (const bool pivoting : {true, false}) {
    const auto hand = pivoting ? record(pivot_motion({}, 1.75), 11.0, 1.75, kGood, 1)
                               : record(drawing_motion(1.2, 0.7, false), 12.0, 1.75, kGood, 1);
    TraceFold fold({}, {});
    std::optional<Event> event;
    for (const auto& sample : hand) {
      EXPECT_FALSE(fold.step(sample.time_s, {true, true, {}}));
      SuitFrame frame;
      frame.time_s = sample.time_s;
      frame[Segment::RightHand] = sample.T_odom_hand;
      fold.record(frame, KeyPose{});
    }
    event = fold.close();
    ASSERT_TRUE(event);
    EXPECT_EQ(std::holds_alternative<Pivot>(*event), pivoting);
    EXPECT_EQ(std::holds_alternative<Trace>(*event), !pivoting);
  }
}

}  // namespace
}  // namespace kinemap
