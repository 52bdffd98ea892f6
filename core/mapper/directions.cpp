// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/directions.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace kinemap {
namespace {

using graph::LandmarkKind;

constexpr double kQuarter = std::numbers::pi / 2.0;
/// A heading less certain than this against the direction may belong to the next right angle as well.
constexpr double kMaxUncertainty = 0.25;  // rad
constexpr double kUnknown = 10.0;         // rad: keeps the direction determined whatever becomes of its walls
const graph::Loss kLoss{graph::Loss::Kind::Cauchy, 3.0};

double squared(double x) { return x * x; }

/// Difference of two headings from the nearest multiple of 90°.
double off_right_angle(double a, double b) { return std::remainder(a - b, kQuarter); }

struct Deviation {
  double mean = 0.0;
  double variance = 0.0;
};

/// By how much wall `wall` deviates from a right angle with landmark `other`, as all factors but `own` (the wall's
/// factor with that landmark, if it has one) see it.
Deviation deviation(const MapState& state, const graph::Marginals& marginals, std::size_t wall, std::size_t other,
                    const graph::ParallelFactor* own) {
  const auto& a = state.graph.landmarks[wall];
  const auto& b = state.graph.landmarks[other];
  const std::array<graph::Variable, 2> pair{graph::Variable{graph::Variable::Kind::Landmark, wall},
                                            graph::Variable{graph::Variable::Kind::Landmark, other}};
  const Eigen::MatrixXd joint = marginals.joint(pair);
  const Eigen::Index at_b = graph::dimension(a.kind);  // both have their heading first
  Deviation d{off_right_angle(a.x[0], b.x[0]), joint(0, 0) + joint(at_b, at_b) - 2.0 * joint(0, at_b)};
  if (own == nullptr) return d;
  const double s = squared(d.mean / own->sigma_rad);
  const double information = 1.0 / (squared(own->sigma_rad) * (1.0 + s / squared(own->loss.scale)));  // Cauchy's weight
  const double rest = 1.0 / d.variance - information;
  // Where nothing but this factor holds the heading, the rest says nothing.
  if (!(rest > 1e-6)) return {d.mean, 1e6};
  return {d.mean / (d.variance * rest), 1.0 / rest};
}

bool keeps_to(const Deviation& d, const MapperConfig::Walls& config) {
  if (d.variance > squared(kMaxUncertainty)) return false;
  const double variance = d.variance + squared(config.right_angle_sigma_rad);
  const double density = std::exp(-0.5 * squared(d.mean) / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
  return (1.0 - config.oblique_share) * density > config.oblique_share / kQuarter;
}

std::vector<std::size_t> walls_of(const MapState& state) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k)
    if (state.graph.landmarks[k].active && state.graph.landmarks[k].kind == LandmarkKind::Wall) out.push_back(k);
  return out;
}

/// The wall that most others are at right angles with.
std::size_t most_common(const MapState& state, const graph::Marginals& marginals, const std::vector<std::size_t>& walls,
                        const MapperConfig::Walls& config) {
  std::size_t best = walls.front();
  long most = -1;
  for (const std::size_t a : walls) {
    const auto agreeing = std::count_if(walls.begin(), walls.end(), [&](std::size_t b) {
      return b != a && keeps_to(deviation(state, marginals, a, b, nullptr), config);
    });
    if (agreeing > most) most = agreeing, best = a;
  }
  return best;
}

graph::ParallelFactor right_angle(const MapState& state, std::size_t wall, const MapperConfig::Walls& config) {
  const double difference = state.graph.landmarks[wall].x[0] - state.graph.landmarks[*state.direction].x[0];
  return {*state.direction, wall, difference - std::remainder(difference, kQuarter), config.right_angle_sigma_rad,
          kLoss};
}

}  // namespace

bool align_walls(MapState& state, const graph::Marginals& marginals, const MapperConfig::Walls& config) {
  const auto walls = walls_of(state);
  if (walls.empty() || config.right_angle_sigma_rad <= 0.0) return false;
  auto& graph = state.graph;
  if (!state.direction) {
    state.direction = graph.landmarks.size();
    graph::Landmark direction;
    direction.kind = LandmarkKind::Direction;
    direction.x[0] = graph.landmarks[walls.front()].x[0];
    graph.landmarks.push_back(direction);
    state.landmarks.push_back({});
    graph.landmark_priors.push_back({*state.direction, 0, direction.x[0], kUnknown});
    graph.parallels = {right_angle(state, walls.front(), config)};
    return false;  // one wall keeps to its own direction: nothing is constrained
  }

  std::vector<std::size_t> aligned;
  bool changed = false;
  for (const std::size_t wall : walls) {
    const auto own = std::find_if(graph.parallels.begin(), graph.parallels.end(),
                                  [wall](const graph::ParallelFactor& f) { return f.b == wall; });
    const bool was = own != graph.parallels.end();
    const bool is = keeps_to(deviation(state, marginals, wall, *state.direction, was ? &*own : nullptr), config) ||
                    (was && graph.parallels.size() == 1);
    if (is) aligned.push_back(wall);
    changed = changed || is != was;
  }
  // A direction that one wall alone keeps to constrains nothing; where others agree with each other it is theirs.
  if (aligned.size() <= 1 && walls.size() >= 2) {
    const std::size_t common = most_common(state, marginals, walls, config);
    graph.landmarks[*state.direction].x[0] = graph.landmarks[common].x[0];
    const std::vector<std::size_t> before = std::exchange(aligned, {});
    for (const std::size_t wall : walls)
      if (wall == common || keeps_to(deviation(state, marginals, wall, common, nullptr), config))
        aligned.push_back(wall);
    changed = aligned != before;
  }
  std::vector<graph::ParallelFactor> parallels;
  for (const std::size_t wall : aligned) parallels.push_back(right_angle(state, wall, config));
  graph.parallels = std::move(parallels);
  return changed;
}

}  // namespace kinemap
