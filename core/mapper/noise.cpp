// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/noise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/graph/optimizer.hpp"
#include "core/graph/variance_components.hpp"

namespace kinemap {
namespace {

constexpr int kRounds = 4;
constexpr int kIterations = 4;  // of the optimiser; each round begins at the optimum of the one before

// Parts of the squared errors that residuals show, on simulated suits whose noise is known: an arm that errs for
// seconds takes the landmark along, a heading that errs for minutes the whole way.
constexpr double kHeadingLeft = 0.4, kContactLeft = 0.45;
constexpr double kHeadingShare = 0.3;  // of its redundancy: headings that err together count as fewer

// What is good about a suit is mostly good about all of it (reference: the columns of the table of suit drift). The
// logarithms of heading, contact and way are those of a usual suit, plus its quality (standard normal) times how much
// of the quality is seen in each, plus something of their own.
const Eigen::Vector3d kUsual(std::log(0.5), 0.0, 0.0);  // of headings the configuration expects the worse
const Eigen::Vector3d kQuality(1.4, 0.6, 0.8);
constexpr double kOwn = 0.25;
constexpr double kSurely = 1.0;  // standard deviation: five in six are better

/// Σ r² of a group at the scale 1 of its noise, and of how many observations.
struct Seen {
  double squares = 0.0, observations = 0.0;
};

Seen seen(const graph::VarianceComponent& found, double scale, double left, double share) {
  return {share * scale * scale * found.squares / left, share * std::max(0.0, found.redundancy)};
}

/// Logarithms of the scales of heading, contact and way.
struct Estimate {
  Eigen::Vector3d u;
  Eigen::Matrix3d covariance;
};

/// The most probable ones: minimises Σ n u + ½ S e^(−2u) over what was seen, plus the prior's
/// ½ (u − usual)ᵀ P (u − usual). Convex, so that Newton's method with short steps gets there.
Estimate most_probable(const Seen& heading, const Seen& contact) {
  const Eigen::Matrix3d prior = (kQuality * kQuality.transpose() + kOwn * kOwn * Eigen::Matrix3d::Identity()).inverse();
  Eigen::Vector3d u = kUsual;
  Eigen::Matrix3d hessian;
  for (int step = 0; step < 50; ++step) {
    Eigen::Vector3d gradient = prior * (u - kUsual);
    hessian = prior;
    for (const auto& [k, group] : {std::pair{0, heading}, std::pair{1, contact}}) {
      const double squares = group.squares * std::exp(-2.0 * u[k]);
      gradient[k] += group.observations - squares;
      hessian(k, k) += 2.0 * squares;
    }
    const Eigen::Vector3d change = hessian.ldlt().solve(gradient).cwiseMax(-1.0).cwiseMin(1.0);
    u -= change;
    if (change.norm() < 1e-6) break;
  }
  return {u, hessian.inverse()};
}

/// As the graph's residuals tell at its present noise; nullopt when the system is singular.
std::optional<Estimate> estimate(const graph::Graph& graph) {
  const auto found = graph::variance_components(graph);
  if (!found) return std::nullopt;
  return most_probable(seen(found->heading, graph.noise.heading, kHeadingLeft, kHeadingShare),
                       seen(found->contact, graph.noise.contact, kContactLeft, 1.0));
}

}  // namespace

graph::NoiseScales estimate_noise(graph::Graph graph) {
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0 && !graph::optimize(graph, {.max_iterations = kIterations}).usable) return {};
    const auto found = estimate(graph);
    if (!found) return {};
    graph.noise = {std::exp(found->u[0]), std::exp(found->u[1]), std::exp(found->u[2])};
  }
  return graph.noise;
}

double most_heading_noise(const graph::Graph& graph) {
  const auto found = estimate(graph);
  return found ? std::exp(found->u[0] + kSurely * std::sqrt(found->covariance(0, 0))) : HUGE_VAL;
}

}  // namespace kinemap
