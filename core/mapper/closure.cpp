// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/closure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace kinemap {
namespace {

using graph::LandmarkKind;

constexpr int kPullIterations = 3;

/// Sets the loss of all factors on the newcomer's visits.
void set_loss(MapState& state, const std::vector<std::size_t>& visits, graph::Loss contact, graph::Loss seat) {
  for (const std::size_t v : visits) {
    const auto& visit = state.observations[v];
    for (std::size_t k = visit.first_contact; k < visit.first_contact + visit.contacts; ++k)
      state.graph.contacts[k].loss = contact;
    if (visit.contacts == 0) state.graph.seats[visit.seat].loss = seat;
  }
}

std::vector<std::size_t> visits_of(const MapState& state, std::size_t landmark) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < state.observations.size(); ++v)
    if (state.observations[v].landmark == landmark) out.push_back(v);
  return out;
}

std::array<std::size_t, 2> ordered(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

std::vector<graph::ParallelFactor> right_angles(const MapState& state, const MapperConfig::Walls& config) {
  std::vector<graph::ParallelFactor> out;
  if (config.right_angle_sigma_rad <= 0.0) return out;
  const auto& landmarks = state.graph.landmarks;
  for (std::size_t a = 0; a < landmarks.size(); ++a) {
    if (!landmarks[a].active || landmarks[a].kind != LandmarkKind::Wall) continue;
    for (std::size_t b = a + 1; b < landmarks.size(); ++b) {
      if (!landmarks[b].active || landmarks[b].kind != LandmarkKind::Wall) continue;
      const double difference = landmarks[b].x[0] - landmarks[a].x[0];
      const double offset = std::round(difference / (std::numbers::pi / 2.0)) * (std::numbers::pi / 2.0);
      if (std::abs(difference - offset) > config.right_angle_max_rad) continue;
      out.push_back({a, b, offset, config.right_angle_sigma_rad, {graph::Loss::Kind::Cauchy, 2.0}});
    }
  }
  return out;
}

bool LoopCloser::optimise(MapState& state, int iterations) const {
  state.graph.parallels = right_angles(state, config_.walls);
  graph::OptimizerOptions options;
  options.max_iterations = iterations;
  const graph::Verdict verdict = graph::optimize(state.graph, options);
  ++state.summary.optimisations;
  if (!verdict.usable)
    ++state.summary.optimisations_failed;
  else
    state.summary.last_cost = verdict.final_cost;
  return verdict.usable;
}

LoopCloser::Trial LoopCloser::attempt(const MapState& state, std::size_t newcomer, const Candidate& candidate) const {
  Trial trial{state, 0.0};
  const auto visits = visits_of(trial.state, newcomer);
  merge(trial.state, newcomer, candidate);
  // A redescending loss would let a far newcomer go before it has pulled: first without, then with it.
  set_loss(trial.state, visits, {}, {});
  optimise(trial.state, kPullIterations);
  set_loss(trial.state, visits, {graph::Loss::Kind::Cauchy, config_.hand.loss_scale},
           {graph::Loss::Kind::Cauchy, config_.seats.loss_scale});
  const bool usable = optimise(trial.state, config_.solver.closure_iterations);
  trial.cost_increase = usable ? 2.0 * (trial.state.summary.last_cost - graph::cost(state.graph)) : HUGE_VAL;
  return trial;
}

bool LoopCloser::close(MapState& state, std::size_t newcomer, const std::vector<Candidate>& found) {
  std::optional<Trial> best;
  double second = HUGE_VAL;
  for (std::size_t k = 0; k < std::min<std::size_t>(found.size(), 2); ++k) {
    // The second one costs a solve; it is only worth it where the linear prediction leaves the question open.
    if (k == 1 && found[1].distance > found[0].distance + 4.0 * config_.association.ambiguity) break;
    Trial trial = attempt(state, newcomer, found[k]);
    if (!best || trial.cost_increase < best->cost_increase) {
      if (best) second = best->cost_increase;
      best = std::move(trial);
    } else {
      second = trial.cost_increase;
    }
  }
  if (!best) return false;
  const bool clear = second - best->cost_increase > config_.association.ambiguity;
  const bool agrees = best->cost_increase <= config_.association.max_cost_increase;
  if (clear && agrees) {
    state = std::move(best->state);
    ++state.summary.loop_closures;
    contradicted_.clear();  // the drift is another now
    return true;
  }
  if (!agrees) ++state.summary.loop_closures_revoked;
  for (const Candidate& candidate : found) contradicted_.push_back(ordered(newcomer, candidate.landmark));
  return false;
}

bool LoopCloser::resolve(MapState& state, std::size_t newcomer) {
  if (const auto marginals = graph::Marginals::compute(state.graph))
    if (close(state, newcomer, candidates(state, newcomer, *marginals, config_.association))) return true;
  state.landmarks[newcomer].id = next_id_++;
  return false;
}

bool LoopCloser::reconsider(MapState& state) {
  bool any = false;
  auto marginals = graph::Marginals::compute(state.graph);
  for (std::size_t k = state.graph.landmarks.size(); marginals && k-- > 0;) {
    if (!state.graph.landmarks[k].active) continue;
    auto found = candidates(state, k, *marginals, config_.association);
    std::erase_if(found, [&](const Candidate& c) {
      return std::find(contradicted_.begin(), contradicted_.end(), ordered(k, c.landmark)) != contradicted_.end();
    });
    if (found.empty() || !close(state, k, found)) continue;
    any = true;
    marginals = graph::Marginals::compute(state.graph);
  }
  return any;
}

}  // namespace kinemap
