// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/graph/optimizer.hpp"
#include "core/graph/variance_components.hpp"

namespace kinemap {
namespace {

constexpr int kRounds = 4;
constexpr int kIterations = 4;     // of the optimiser; each round begins at the optimum of the one before
constexpr double kExpected = 5.0;  // what the configuration expects is worth so many observations
constexpr double kLeft = 0.6;  // part of the contacts' errors that residuals show: an arm that errs for seconds takes
                               // the landmark along (0.5 to 0.7 on simulated suits whose noise is known)

/// The factor on the standard deviation for the next round.
double improved(double scale, const graph::VarianceComponent& found, double shown) {
  const double squares = scale * scale * found.squares / shown;
  return std::sqrt((kExpected + squares) / (kExpected + std::max(0.0, found.redundancy)));
}

}  // namespace

graph::NoiseScales estimate_noise(graph::Graph graph) {
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0 && !graph::optimize(graph, {.max_iterations = kIterations}).usable) return {};
    const auto found = graph::variance_components(graph);
    if (!found) return {};
    graph.noise.heading = improved(graph.noise.heading, found->heading, 1.0);
    graph.noise.contact = improved(graph.noise.contact, found->contact, kLeft);
  }
  return graph.noise;
}

double heading_noise(const graph::Graph& graph) {
  const auto found = graph::variance_components(graph);
  return found ? improved(1.0, found->heading, 1.0) : 1.0;
}

}  // namespace kinemap
