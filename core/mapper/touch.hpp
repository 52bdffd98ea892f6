// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/graph/marginals.hpp"
#include "core/landmarks/extract.hpp"
#include "core/map.hpp"
#include "core/mapper/config.hpp"

namespace kinemap {

/// What is believed of the point with which the right hand touches: a mixture of two Gaussians, the finger tips and the
/// flat palm, in the hand segment's frame (m). Four sources, each counted once:
/// - what the body says (configuration, else body points of the suit, else stature) gives the means and sigmas;
/// - pivot gestures measure the point: they sharpen both parts and tell them apart;
/// - the hand's slant on a surface tells them apart: with the palm on it, the fingers cannot point into it;
/// - the graph's contacts tell them apart.
/// The graph takes one Gaussian as the point's prior. It gets the mixture's mean and spread: wide while the part is in
/// question, as narrow as the part when it is not. The point itself is then estimated by the graph.
class TouchBelief {
 public:
  explicit TouchBelief(const MapperConfig::Hand& config);

  /// Renews what the body says; the stature that bone lengths give away is used where nothing better is known.
  void expect(const WearerInfo& wearer, std::optional<double> stature_m);

  /// A pivot gesture. Repeated ones add up.
  void add(const Pivot& pivot);

  /// How the hand lay on an object that was just traced.
  void see(const Observation& observation, const Trace& trace, const graph::Graph& graph);

  /// Judges the parts by the contacts: `touch` is the optimum under its prior, `covariance` that of touch_covariance().
  /// What the prior brought is taken out (information form), so that nothing counts twice. Only of use right after an
  /// optimisation.
  void judge(const graph::TouchPoint& touch, const Eigen::Matrix3d& covariance);

  /// The mixture as one Gaussian; `p_hand` is its mean.
  [[nodiscard]] graph::TouchPoint prior() const;

  [[nodiscard]] double palm_probability() const;

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    for (Gaussian& part : expected_) a(part.mean, part.covariance, part.log_weight);
    for (Evidence* evidence : {&pivots_, &contacts_}) a(evidence->information, evidence->vector);
    for (Mean& mean : fingers_into_) a(mean.sum, mean.count);
  }

 private:
  struct Gaussian {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    double log_weight = 0.0;  ///< not normalised
  };
  /// What is known of the point from elsewhere, up to a constant factor: exp(−½ pᵀ·information·p + vectorᵀ·p).
  struct Evidence {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  };
  struct Mean {
    double sum = 0.0;
    int count = 0;
  };

  static Gaussian combine(const Gaussian& expected, const Evidence& evidence);
  /// Tips and palm after the pivots, weighted by everything.
  [[nodiscard]] std::array<Gaussian, 2> parts() const;
  [[nodiscard]] double flat_hand_log_odds() const;
  [[nodiscard]] bool taken_as_it_is() const { return config_.tip_sigma_m <= 0.0; }

  MapperConfig::Hand config_;
  std::array<Gaussian, 2> expected_;  ///< tips, palm
  Evidence pivots_;
  Evidence contacts_;
  std::array<Mean, 2> fingers_into_;  ///< sine of the fingers' angle into level and into upright surfaces
};

/// Marginal covariance of a touching point at the optimum, m², without the information that noisy turns of the hand
/// feign (graph::TouchPoint): the curvature −Σ ρ'‖r‖²·k²/(1 + k²‖p‖²) of the cost, which Gauss-Newton does not see.
/// Zero when the point is fixed.
Eigen::Matrix3d touch_covariance(const graph::Graph& graph, const graph::Marginals& marginals, std::size_t touch);

/// What the map says of the hand: the likelier part, the point's estimate and its sigmas.
TouchingHand describe_hand(const TouchBelief& belief, const graph::TouchPoint& touch,
                           const Eigen::Matrix3d& covariance);

}  // namespace kinemap
