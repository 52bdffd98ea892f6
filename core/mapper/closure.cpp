// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/closure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/mapper/directions.hpp"
#include "core/mapper/free_space.hpp"
#include "core/mapper/noise.hpp"
#include "core/mapper/reassign.hpp"

namespace kinemap {
namespace {

using graph::LandmarkKind;

constexpr int kPullIterations = 3;
constexpr int kReassignRounds = 2;
constexpr double kLeastDoubt = 0.35;  // of the expected one: so sure of a suit nobody is
constexpr double kAlike = 1.5;        // m by which two closures that bear each other out may move things differently

/// Sets the loss of all factors on the newcomer's visits.
void set_loss(MapState& state, const std::vector<std::size_t>& visits, graph::Loss contact, graph::Loss seat) {
  for (const std::size_t v : visits) {
    const auto& visit = state.observations[v];
    for (std::size_t k = visit.first_contact; k < visit.first_contact + visit.contacts; ++k)
      state.graph.contacts[k].loss = contact;
    if (visit.has_seat()) state.graph.seats[visit.seat].loss = seat;
  }
}

std::vector<std::size_t> visits_of(const MapState& state, std::size_t landmark) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < state.observations.size(); ++v)
    if (state.observations[v].landmark == landmark) out.push_back(v);
  return out;
}

/// A closure that might be: `landmark` is what stands for `candidate`, too.
struct Pair {
  std::size_t landmark;
  Candidate candidate;
};

/// Whether both closures would move what was seen later by about the same. Of a wall nobody knows where along it.
bool agree(const std::vector<graph::Landmark>& landmarks, const Pair& a, const Pair& b) {
  if (a.landmark == b.landmark || a.candidate.landmark == b.candidate.landmark) return false;
  for (const Pair& pair : {a, b})
    if (landmarks[pair.landmark].kind == LandmarkKind::Wall) return true;
  const auto move = [&](const Pair& pair) -> Eigen::Vector3d {
    return graph::landmark_pose(landmarks[pair.candidate.landmark]).p -
           graph::landmark_pose(landmarks[pair.landmark]).p;
  };
  return (move(a) - move(b)).head<2>().norm() < kAlike;
}

/// One closure and those that it makes likely.
struct JointHypothesis {
  MapState state;
  std::vector<std::array<std::size_t, 2>> pairs;  ///< landmark, candidate
  double evidence;

  [[nodiscard]] bool contradicts(const JointHypothesis& other) const {
    return std::any_of(pairs.begin(), pairs.end(), [&](const auto& a) {
      return std::any_of(other.pairs.begin(), other.pairs.end(),
                         [&](const auto& b) { return (a[0] == b[0]) != (a[1] == b[1]); });
    });
  }
};

std::array<std::size_t, 2> ordered(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

bool LoopCloser::optimise(MapState& state, int iterations) const {
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

bool LoopCloser::settle(MapState& state, int iterations) const {
  bool usable = optimise(state, iterations);
  // Sides were chosen on raw odometry; a few rounds are enough, since each choice has hysteresis.
  for (int round = 0; round < kReassignRounds && usable && reassign_edges(state) > 0; ++round)
    usable = optimise(state, iterations);
  return usable;
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

bool LoopCloser::is_clear(const MapState& state, const graph::Marginals& marginals,
                          const std::vector<Candidate>& found) const {
  const auto is_rival = [&](const Candidate& c) {
    return c.landmark != found[0].landmark && found[0].evidence - c.evidence <= config_.association.ambiguity;
  };
  if (std::none_of(found.begin(), found.end(), is_rival)) return true;
  // Two that may be one and the same are no rivals: what is one with the first is one with both, or tells them apart.
  const auto alike = candidates(state, found[0].landmark, marginals, config_.association);
  return std::all_of(found.begin(), found.end(), [&](const Candidate& c) {
    return !is_rival(c) || std::any_of(alike.begin(), alike.end(),
                                       [&](const Candidate& other) { return other.landmark == c.landmark; });
  });
}

bool LoopCloser::close(MapState& state, std::size_t newcomer, const graph::Marginals& marginals,
                       std::vector<Candidate> found) {
  const auto& config = config_.association;
  if (found.empty()) return false;
  // A closure may mend what contradicts the map as it stands: so much evidence a trial can bring at most.
  const double apart = free_space_cost(state, &marginals, config.free_space_most);
  std::optional<Trial> best;
  double most = config.min_evidence;
  for (Candidate& candidate : found) {
    if (candidate.evidence + apart < config.min_evidence) continue;
    Trial trial = attempt(state, newcomer, candidate);
    candidate.evidence += apart - free_space_cost(trial.state, nullptr, config.free_space_most);
    if (candidate.evidence < most) continue;
    most = candidate.evidence;
    best = std::move(trial);
  }
  if (!best) return false;
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& x, const Candidate& y) { return x.evidence > y.evidence; });
  if (is_clear(state, marginals, found)) {
    if (best->cost_increase <= config.max_cost_increase) {
      state = std::move(best->state);
      ++state.summary.loop_closures;
      contradicted_.clear();  // the drift is another now
      return true;
    }
    ++state.summary.loop_closures_revoked;
  }
  for (const Candidate& candidate : found) contradicted_.push_back(ordered(newcomer, candidate.landmark));
  return false;
}

bool LoopCloser::align(MapState& state) const {
  const auto marginals = graph::Marginals::compute(state.graph);
  return marginals && align_walls(state, *marginals, config_.walls) &&
         optimise(state, config_.solver.closure_iterations);
}

void LoopCloser::learn(const MapState& state) {
  config_.association.doubt = expected_doubt_ * std::clamp(most_heading_noise(state.graph), kLeastDoubt, 1.0);
}

bool LoopCloser::resolve(MapState& state, std::size_t newcomer) {
  settle(state, config_.solver.closure_iterations);  // candidates are judged at an optimum
  learn(state);
  if (state.graph.landmarks[newcomer].kind == LandmarkKind::Wall) align(state);
  const auto marginals = graph::Marginals::compute(state.graph);
  if (marginals && close(state, newcomer, *marginals, candidates(state, newcomer, *marginals, config_.association)))
    return true;
  state.landmarks[newcomer].id = next_id_++;
  return marginals && close_jointly(state, *marginals);
}

bool LoopCloser::is_contradicted(std::size_t a, std::size_t b) const {
  return std::find(contradicted_.begin(), contradicted_.end(), ordered(a, b)) != contradicted_.end();
}

bool LoopCloser::close_jointly(MapState& state, const graph::Marginals& marginals) {
  const auto& config = config_.association;
  std::vector<Pair> open;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    if (!state.graph.landmarks[k].active || state.landmarks[k].id == 0) continue;
    for (const Candidate& c : candidates(state, k, marginals, config))
      if (c.landmark < k && c.evidence > config.joint_evidence && !is_contradicted(k, c.landmark))
        open.push_back({k, c});
  }
  const double apart = open.size() < 2 ? 0.0 : free_space_cost(state, &marginals, config.free_space_most);
  std::vector<JointHypothesis> hypotheses;
  for (const Pair& first : open) {
    if (std::none_of(open.begin(), open.end(), [&](const Pair& p) { return agree(state.graph.landmarks, first, p); }))
      continue;
    Trial trial = attempt(state, first.landmark, first.candidate);
    const auto closed = graph::Marginals::compute(trial.state.graph);
    if (trial.cost_increase > config.max_cost_increase || !closed) continue;
    JointHypothesis joint{
        std::move(trial.state), {{first.landmark, first.candidate.landmark}}, first.candidate.evidence};
    joint.evidence += apart - free_space_cost(joint.state, &*closed, config.free_space_most);
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::size_t landmark = open[k].landmark;
      if (landmark == first.landmark || (k > 0 && open[k - 1].landmark == landmark)) continue;
      const auto likely = candidates(joint.state, landmark, *closed, config);
      if (likely.empty() || likely[0].landmark > landmark || likely[0].evidence < config.min_evidence) continue;
      joint.evidence += likely[0].evidence;
      joint.pairs.push_back({landmark, likely[0].landmark});
    }
    if (joint.pairs.size() > 1) hypotheses.push_back(std::move(joint));
  }
  const auto best = std::max_element(hypotheses.begin(), hypotheses.end(),
                                     [](const auto& a, const auto& b) { return a.evidence < b.evidence; });
  if (best == hypotheses.end() || best->evidence < config.min_evidence) return false;
  const bool clear = std::none_of(hypotheses.begin(), hypotheses.end(), [&](const JointHypothesis& other) {
    return best->contradicts(other) && best->evidence - other.evidence <= config.ambiguity;
  });
  if (!clear) return false;
  state = std::move(best->state);
  ++state.summary.loop_closures;
  contradicted_.clear();
  return true;
}

bool LoopCloser::revise(MapState& state, const std::function<bool()>& enough) {
  bool any = false;
  const double most = config_.association.free_space_most;
  double merged = free_space_cost(state, nullptr, most);
  for (std::size_t v = state.observations.size(); v-- > 0;) {
    if (enough && enough()) break;
    if (state.observations[v].key_pose < state.graph.first_free_pose) continue;  // settled
    if (visits_of(state, state.observations[v].landmark).size() < 2) continue;
    MapState trial = state;
    const std::size_t alone = split(trial, v);
    if (!optimise(trial, config_.solver.closure_iterations)) continue;
    double relief = merged + 2.0 * (graph::cost(state.graph) - trial.summary.last_cost);
    if (relief >= config_.association.min_relief) relief -= free_space_cost(trial, nullptr, most);
    const auto& landmarks = trial.graph.landmarks;
    const bool contradicts = relief >= config_.association.min_relief &&
                             !in_one_place(landmarks[alone], landmarks[state.observations[v].landmark]);
    if (!contradicts && !touched_elsewhere(state, v)) continue;
    contradicted_.push_back(ordered(alone, state.observations[v].landmark));
    state = std::move(trial);
    merged = free_space_cost(state, nullptr, most);
    state.landmarks[alone].id = next_id_++;
    ++state.summary.loop_closures_revoked;
    any = true;
  }
  return any;
}

bool LoopCloser::reconsider(MapState& state) {
  bool any = false;
  learn(state);
  auto marginals = graph::Marginals::compute(state.graph);
  for (std::size_t k = state.graph.landmarks.size(); marginals && k-- > 0;) {
    if (!state.graph.landmarks[k].active || state.landmarks[k].id == 0) continue;
    auto found = candidates(state, k, *marginals, config_.association);
    std::erase_if(found, [&](const Candidate& c) { return is_contradicted(k, c.landmark); });
    if (found.empty() || !close(state, k, *marginals, found)) continue;
    any = true;
    marginals = graph::Marginals::compute(state.graph);
  }
  if (align(state)) any = true;
  return any;
}

}  // namespace kinemap
