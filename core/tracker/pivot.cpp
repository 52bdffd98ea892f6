// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/pivot.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace kinemap {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Where a hand can touch at all, in its own frame: keeps the direction in which nothing turned within the hand while
// the inliers are sought. It is no part of the measurement.
const Vector3d kInHand(0.0, -0.14, -0.01);
const Vector3d kInHandSigma(0.04, 0.08, 0.04);
constexpr std::array<double, 6> kCloserAndCloser{0.20, 0.15, 0.10, 0.10, 0.10, 0.10};  // m, inliers, by iteration
constexpr double kClosest = 0.03;      // m; how close they may be chosen where the noise is small
constexpr double kLongestStep = 0.15;  // s; a gap in the stream is no time on the spot

struct Fit {
  Vector3d p_hand = kInHand;
  Vector3d spot = Vector3d::Zero();
};

/// Time that each sample stands for: thinning by distance must not give the swift parts more weight.
std::vector<double> durations(std::span<const HandSample> samples) {
  std::vector<double> out(samples.size(), 0.0);
  for (std::size_t k = 1; k < samples.size(); ++k)
    out[k] = std::min(kLongestStep, samples[k].time_s - samples[k - 1].time_s);
  return out;
}

double residual(const HandSample& sample, const Fit& fit) {
  return (sample.T_odom_hand * fit.p_hand - fit.spot).norm();
}

/// Normal equations of Σ w ‖R_i p + t_i − c‖² in (p, c).
struct Normal {
  Matrix6 a = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  void add(const HandSample& sample, double weight) {
    const Matrix3d r = sample.T_odom_hand.q.toRotationMatrix();
    a.topLeftCorner<3, 3>() += weight * Matrix3d::Identity();
    a.topRightCorner<3, 3>() -= weight * r.transpose();
    a.bottomLeftCorner<3, 3>() -= weight * r;
    a.bottomRightCorner<3, 3>() += weight * Matrix3d::Identity();
    b.head<3>() -= weight * (r.transpose() * sample.T_odom_hand.p);
    b.tail<3>() += weight * sample.T_odom_hand.p;
  }
  /// What the samples say of p alone, per m² of noise and second: large where the hand turned.
  [[nodiscard]] Matrix3d information() const {
    return a.topLeftCorner<3, 3>() -
           a.topRightCorner<3, 3>() * a.bottomRightCorner<3, 3>().inverse() * a.bottomLeftCorner<3, 3>();
  }
};

/// With p kept near the hand by `sigma`, as strongly as one second of samples with noise `noise_m` would.
Fit solve(const Normal& normal, double noise_m, const Vector3d& sigma) {
  const Matrix3d keep = (noise_m * sigma.cwiseInverse()).cwiseAbs2().asDiagonal();
  Matrix6 a = normal.a;
  Vector6 b = normal.b;
  a.topLeftCorner<3, 3>() += keep;
  b.head<3>() += keep * kInHand;
  const Vector6 x = a.ldlt().solve(b);
  return {x.head<3>(), x.tail<3>()};
}

/// The place where the nominal point was longest: where most of it lies near.
Fit start(std::span<const HandSample> samples, const std::vector<double>& time) {
  Fit best;
  double longest = -1.0;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / 64);
  for (std::size_t k = 0; k < samples.size(); k += stride) {
    const Fit here{kInHand, samples[k].T_odom_hand * kInHand};
    double near = 0.0;
    for (std::size_t j = 0; j < samples.size(); ++j)
      if (residual(samples[j], here) < kCloserAndCloser.front()) near += time[j];
    if (near > longest) longest = near, best = here;
  }
  return best;
}

/// First and last sample of the time on the spot; nullopt when the hand left it in between.
std::optional<std::span<const HandSample>> on_spot(std::span<const HandSample> samples, const Fit& fit,
                                                   const TrackerConfig::Pivot& config) {
  const auto near = [&](const HandSample& s) { return residual(s, fit) < kCloserAndCloser.back(); };
  const auto first = std::find_if(samples.begin(), samples.end(), near);
  const auto last = std::find_if(samples.rbegin(), samples.rend(), near).base();
  if (first >= last) return std::nullopt;
  const double begin_s = first->time_s, end_s = std::prev(last)->time_s;
  const auto inside = static_cast<double>(std::count_if(first, last, near));
  if (end_s - begin_s < config.min_duration_s || inside < 0.9 * static_cast<double>(last - first) ||
      begin_s - samples.front().time_s > config.reach_max_s || samples.back().time_s - end_s > config.reach_max_s)
    return std::nullopt;
  return std::span<const HandSample>(first, last);
}

double largest_turn(std::span<const HandSample> samples) {
  double turn = 0.0;
  for (const HandSample& s : samples)
    turn = std::max(turn, s.T_odom_hand.q.angularDistance(samples.front().T_odom_hand.q));
  return turn;
}

bool in_hand(const Vector3d& p) { return -p.y() > 0.04 && -p.y() < 0.28 && std::hypot(p.x(), p.z()) < 0.10; }

/// The point and the spot that explain most of the time, and the samples that they explain.
struct RobustFit {
  Fit fit;
  Normal normal;
  double used_s = 0.0;
  double rms_m = HUGE_VAL;  ///< distance from the spot
};
std::optional<RobustFit> fit_robustly(std::span<const HandSample> samples, const TrackerConfig::Pivot& config) {
  const auto time = durations(samples);
  RobustFit out;
  out.fit = start(samples, time);
  for (const double farthest : kCloserAndCloser) {
    const double limit = std::clamp(3.0 * out.rms_m, kClosest, farthest);
    std::vector<std::size_t> inliers;
    for (std::size_t k = 0; k < samples.size(); ++k)
      if (residual(samples[k], out.fit) < limit) inliers.push_back(k);
    out.normal = {};
    out.used_s = 0.0;
    for (const std::size_t k : inliers) out.normal.add(samples[k], time[k]), out.used_s += time[k];
    if (out.used_s < config.min_duration_s) return std::nullopt;
    out.fit = solve(out.normal, config.noise_m, kInHandSigma);
    double squares = 0.0;
    for (const std::size_t k : inliers) squares += time[k] * std::pow(residual(samples[k], out.fit), 2);
    out.rms_m = std::sqrt(squares / out.used_s);
  }
  return out;
}

/// Weight of one second of samples, 1/m²: independent ones in it over their variance along each axis. Three numbers a
/// sample, six of them spent on p and c: what is left of the noise after the fit is too small by as much.
double weight_per_second(const RobustFit& robust, const TrackerConfig::Pivot& config) {
  const double independent = std::max(2.5, robust.used_s / config.independent_s);
  const double noise = std::max(config.noise_m, robust.rms_m / std::sqrt(3.0 * (1.0 - 2.0 / independent)));
  return independent / robust.used_s / (noise * noise);
}

}  // namespace

std::optional<Pivot> find_pivot(std::span<const HandSample> samples, const TrackerConfig::Pivot& config) {
  if (config.min_duration_s <= 0.0 || samples.size() < 8) return std::nullopt;
  const auto robust = fit_robustly(samples, config);
  if (!robust || robust->rms_m > config.max_residual_m || !in_hand(robust->fit.p_hand)) return std::nullopt;
  const auto held = on_spot(samples, robust->fit, config);
  if (!held || largest_turn(*held) < config.min_turn_rad) return std::nullopt;

  // Here p is only kept finite: a direction in which nothing turned comes out as unknown, to a metre.
  const double weight = weight_per_second(*robust, config);
  const Matrix3d information = weight * robust->normal.information() + Matrix3d::Identity();
  // But to tell whether it is of use, what is known of every hand may help.
  const Matrix3d in_hand_information = kInHandSigma.cwiseAbs2().cwiseInverse().asDiagonal();
  if ((information + in_hand_information).inverse()(1, 1) > config.useful_m * config.useful_m) return std::nullopt;
  Pivot pivot;
  pivot.begin_s = held->front().time_s;
  pivot.end_s = held->back().time_s;
  pivot.p_hand = solve(robust->normal, std::sqrt(1.0 / weight), Vector3d::Ones()).p_hand;
  pivot.covariance = information.inverse() + config.systematic_m * config.systematic_m * Matrix3d::Identity();
  return pivot;
}

}  // namespace kinemap
