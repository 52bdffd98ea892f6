// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/touch.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/mapper/observe.hpp"

namespace kinemap {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Evidence of the contacts for a part is taken to this power: errors of the arm that repeat at every visit, and a wrong
// association here and there, speak louder than the noise model knows.
constexpr double kTrustInContacts = 0.5;

constexpr double kTypicalStature = 1.72;  // m, of a wearer of whom nothing is known

// A flat palm allows for some tilt and the arm's noise; fingers that point into the surface cannot have the palm on it.
// But finger tips draw with a flat hand as well, and not every suit tells the hand's orientation well: the odds are
// bounded, for level and for upright surfaces each.
constexpr double kFlatSine = 0.05, kFlatSineSigma = 0.2;
constexpr double kPalmOddsFlat = 2.4, kPalmOddsSlanted = 0.35;

// In the T-pose the right hand points along its −y axis with the palm down: what touches lies on the −z side.
Vector3d point_of(double along_m, double thickness_m) { return {0.0, -along_m, -thickness_m}; }

/// The suit's points of the hand lie on its skeleton; what touches is the skin beneath.
Vector3d on_skin(Vector3d p, double thickness_m) {
  p.z() = std::min(p.z(), -thickness_m);
  return p;
}

Matrix3d covariance_of(double along_m, double across_m) {
  return Vector3d(across_m * across_m, along_m * along_m, across_m * across_m).asDiagonal();
}

Matrix3d information_of(const graph::TouchPoint& touch) { return touch.sigma.cwiseAbs2().cwiseInverse().asDiagonal(); }

/// Mean over the contacts.
double fingers_into(const Observation& observation, const Trace& trace, const graph::Graph& graph) {
  double sum = 0.0;
  for (const std::size_t k : observation.contacts) sum += fingers_into(observation.landmark, trace.contacts[k], graph);
  return sum / static_cast<double>(observation.contacts.size());
}

/// Σ ρ'‖r‖² over the contacts with a touching point.
double weighted_squares(const graph::Graph& graph, std::size_t touch) {
  double sum = 0.0;
  for (const graph::ContactFactor& c : graph.contacts)
    if (c.touch == touch && graph.landmarks[c.landmark].active) sum += graph::weighted_square(graph, c);
  for (const graph::FoldedFactor& f : graph.folded)
    if (f.touch == touch && graph.landmarks[f.landmark].active) sum += f.weighted_squares;
  return sum;
}

}  // namespace

TouchBelief::TouchBelief(const MapperConfig::Hand& config) : config_(config) { expect({}, std::nullopt); }

void TouchBelief::expect(const WearerInfo& wearer, std::optional<double> stature_m) {
  const double stature = wearer.stature_m.value_or(stature_m.value_or(kTypicalStature));
  const bool configured = config_.tip_m > 0.0;
  const double palm_share = configured || taken_as_it_is() ? 0.0 : config_.palm_share;
  auto& [tips, palm] = expected_;
  const Vector3d tip = configured ? point_of(config_.tip_m, 0.0)
                                  : wearer.p_hand_fingertip.value_or(point_of(config_.tip_per_stature * stature, 0.0));
  tips.mean = on_skin(tip, config_.tip_thickness_m);
  palm.mean =
      on_skin(wearer.p_hand_palm.value_or(point_of(config_.palm_per_stature * stature, 0.0)), config_.palm_thickness_m);
  const bool measured = configured || wearer.p_hand_fingertip;
  const double tip_sigma_m = measured ? config_.body_point_sigma_m : config_.tip_sigma_m;
  tips.covariance = covariance_of(std::max(tip_sigma_m, 1e-4), config_.tip_sideways_sigma_m);
  palm.covariance = covariance_of(config_.palm_sigma_m, config_.tip_sideways_sigma_m);
  tips.log_weight = std::log(1.0 - palm_share);
  palm.log_weight = std::log(palm_share);
}

TouchBelief::Gaussian TouchBelief::combine(const Gaussian& expected, const Evidence& evidence) {
  const Matrix3d prior = expected.covariance.inverse();
  const Vector3d vector = prior * expected.mean + evidence.vector;
  Gaussian out;
  out.covariance = (prior + evidence.information).inverse();
  out.mean = out.covariance * vector;
  // log ∫ evidence(p) N(p; expected) dp, but for a constant that both parts share.
  out.log_weight = expected.log_weight + 0.5 * (std::log(out.covariance.determinant() * prior.determinant()) +
                                                vector.dot(out.mean) - expected.mean.dot(prior * expected.mean));
  return out;
}

void TouchBelief::add(const Pivot& pivot) {
  const Matrix3d information = pivot.covariance.inverse();
  pivots_.information += information;
  pivots_.vector += information * pivot.p_hand;
}

void TouchBelief::see(const Observation& observation, const Trace& trace, const graph::Graph& graph) {
  Mean& mean = fingers_into_[observation.landmark.kind == graph::LandmarkKind::Table ? 0 : 1];
  mean.sum += fingers_into(observation, trace, graph);
  ++mean.count;
}

double TouchBelief::flat_hand_log_odds() const {
  double sum = 0.0;
  for (const Mean& mean : fingers_into_) {
    if (mean.count == 0) continue;
    const double off = (mean.sum / mean.count - kFlatSine) / kFlatSineSigma;
    sum += std::log(kPalmOddsSlanted + (kPalmOddsFlat - kPalmOddsSlanted) * std::exp(-0.5 * off * off));
  }
  return sum;
}

void TouchBelief::judge(const graph::TouchPoint& touch, const Matrix3d& covariance) {
  if (touch.fixed) return;
  const Matrix3d information = covariance.inverse() - information_of(touch);
  // At the optimum: contacts · (p − their best) + prior · (p − expected) = 0.
  const Vector3d vector = information * touch.p_hand + information_of(touch) * (touch.p_hand - touch.prior);
  contacts_ = {kTrustInContacts * information, kTrustInContacts * vector};
}

std::array<TouchBelief::Gaussian, 2> TouchBelief::parts() const {
  std::array<Gaussian, 2> out;
  for (std::size_t k = 0; k < 2; ++k) {
    out[k] = combine(expected_[k], pivots_);
    out[k].log_weight = combine(out[k], contacts_).log_weight;
  }
  out[1].log_weight += flat_hand_log_odds();
  return out;
}

double TouchBelief::palm_probability() const {
  const auto [tips, palm] = parts();
  return 1.0 / (1.0 + std::exp(tips.log_weight - palm.log_weight));
}

graph::TouchPoint TouchBelief::prior() const {
  if (taken_as_it_is()) return {expected_[0].mean, expected_[0].mean, Vector3d::Zero(), true};
  const auto [tips, palm] = parts();
  const double p = palm_probability();
  const Vector3d mean = (1.0 - p) * tips.mean + p * palm.mean;
  const Vector3d variance = (1.0 - p) * tips.covariance.diagonal() + p * palm.covariance.diagonal() +
                            p * (1.0 - p) * (palm.mean - tips.mean).cwiseAbs2();
  return {mean, mean, variance.cwiseSqrt(), taken_as_it_is(), config_.turn_noise_rad_per_m};
}

Matrix3d touch_covariance(const graph::Graph& graph, const graph::Marginals& marginals, std::size_t touch) {
  const graph::TouchPoint& point = graph.touch_points[touch];
  if (point.fixed) return Matrix3d::Zero();
  const std::array<graph::Variable, 1> variable{{{graph::Variable::Kind::Touch, touch}}};
  const double k2 = point.turn_noise_rad_per_m * point.turn_noise_rad_per_m;
  const double variance = 1.0 + k2 * point.p_hand.squaredNorm();
  const double wider = variance / (1.0 + k2 * point.prior.squaredNorm());
  const double feigned = weighted_squares(graph, touch) / wider * k2 / variance;
  // Contacts may say nothing, but never less: where less than nothing remains, the prior stays alone.
  const Matrix3d contacts = Matrix3d(marginals.joint(variable)).inverse() - information_of(point);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(contacts);
  const Vector3d kept = (solver.eigenvalues().array() - feigned).cwiseMax(0.0);
  return (information_of(point) + solver.eigenvectors() * kept.asDiagonal() * solver.eigenvectors().transpose())
      .inverse();
}

TouchingHand describe_hand(const TouchBelief& belief, const graph::TouchPoint& touch, const Matrix3d& covariance) {
  const double palm = belief.palm_probability();
  return {palm > 0.5 ? HandPart::Palm : HandPart::Tips, std::max(palm, 1.0 - palm), touch.p_hand,
          covariance.diagonal().cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace kinemap
