// SPDX-License-Identifier: Apache-2.0
#include "core/graph/residual_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace kinemap::graph {
namespace {

template <class Factor>
PoseIndex index_by_pose(const std::vector<Factor>& factors, std::size_t poses) {
  PoseIndex index;
  index.start.assign(poses + 1, 0);
  for (const Factor& f : factors) ++index.start[f.i + 1];
  std::partial_sum(index.start.begin(), index.start.end(), index.start.begin());
  index.items.resize(factors.size());
  std::vector<std::uint32_t> next(index.start.begin(), index.start.end() - 1);
  for (std::size_t k = 0; k < factors.size(); ++k) index.items[next[factors[k].i]++] = static_cast<std::uint32_t>(k);
  return index;
}

auto contact_key(const ContactFactor& f) { return std::tie(f.i, f.landmark, f.touch); }

}  // namespace

Values::Values(const Graph& graph)
    : poses(graph.poses.size()),
      landmarks(graph.landmarks.size()),
      touch_points(graph.touch_points.size()),
      scalars(graph.scalars) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& T = graph.poses[i];
    poses[i] = {T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()};
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i] = graph.landmarks[i].x;
  for (std::size_t i = 0; i < touch_points.size(); ++i) {
    Eigen::Map<Eigen::Vector3d>(touch_points[i].data()) = graph.touch_points[i].p_hand;
  }
}

void Values::write_to(Graph& graph) const {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& x = poses[i];
    graph.poses[i] = {{x[0], x[1], x[2]}, Eigen::Quaterniond(x[6], x[3], x[4], x[5])};
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) graph.landmarks[i].x = landmarks[i];
  for (std::size_t i = 0; i < touch_points.size(); ++i) {
    graph.touch_points[i].p_hand = Eigen::Map<const Eigen::Vector3d>(touch_points[i].data());
  }
  graph.scalars = scalars;
}

bool Values::all_finite() const {
  const auto finite = [](const auto& block) {
    return std::all_of(block.begin(), block.end(), [](double x) { return std::isfinite(x); });
  };
  return std::all_of(poses.begin(), poses.end(), finite) && std::all_of(landmarks.begin(), landmarks.end(), finite) &&
         std::all_of(touch_points.begin(), touch_points.end(), finite) && finite(scalars);
}

double evaluate_cost(const std::vector<ResidualBlock>& blocks) {
  double sum = 0.0;
  std::vector<double> residuals;
  for (const ResidualBlock& block : blocks) {
    residuals.resize(static_cast<std::size_t>(block.cost->num_residuals()));
    if (!block.cost->Evaluate(block.parameters.data(), residuals.data(), nullptr))
      return std::numeric_limits<double>::quiet_NaN();
    for (const double r : residuals) sum += r * r;
  }
  return 0.5 * sum;
}

ResidualBlocks::ResidualBlocks(const Graph& graph, Values& values, std::size_t first_free_pose)
    : graph_(graph), values_(values), first_free_pose_(first_free_pose) {
  blocks.reserve(graph.between.size() + graph.poses.size() + graph.contacts.size() + graph.seats.size());
  add_pose_factors();
  add_headings();
  add_contacts();
  add_landmark_factors();
  add_touch_priors();
  add_folded();
}

void ResidualBlocks::add_pose_factors() {
  for (const BetweenFactor& f : graph_.between) {
    add(between_costs_.emplace_back(f, graph_.noise), {static_cast<VariableId>(f.i), static_cast<VariableId>(f.j)});
  }
  gravity_ = index_by_pose(graph_.gravity, graph_.poses.size());
  floors_ = index_by_pose(graph_.floors, graph_.poses.size());
  priors_ = index_by_pose(graph_.priors, graph_.poses.size());
  for (std::size_t i = 0; i < graph_.poses.size(); ++i) {
    const Indices gravity = gravity_.of(i), floors = floors_.of(i), priors = priors_.of(i);
    if (gravity.empty() && floors.empty() && priors.empty()) continue;
    add(pose_costs_.emplace_back(graph_, gravity, floors, priors), {static_cast<VariableId>(i)});
  }
}

void ResidualBlocks::add_headings() {
  for (const CompassFactor& f : graph_.compasses) {
    const CompassCost& cost = compass_costs_.emplace_back(f, graph_.noise);
    const VariableId i = static_cast<VariableId>(f.i), j = static_cast<VariableId>(f.j);
    if (f.i == f.j)
      add(cost, {j, scalar_id(f.north)}, Group::Heading);
    else
      add(cost, {i, j, scalar_id(f.north)}, Group::Heading);
  }
  for (const DriftFactor& f : graph_.drifts)
    add(drift_costs_.emplace_back(f, graph_.noise), {scalar_id(f.a), scalar_id(f.b), scalar_id(f.rate)},
        Group::Heading);
  for (const ScalarPrior& f : graph_.scalar_priors)
    add(scalar_prior_costs_.emplace_back(f, graph_.noise), {scalar_id(f.scalar)}, Group::Heading);
}

void ResidualBlocks::add_contacts() {
  contacts_.reserve(graph_.contacts.size());
  for (std::size_t k = 0; k < graph_.contacts.size(); ++k) {
    if (graph_.landmarks[graph_.contacts[k].landmark].active) contacts_.push_back(static_cast<std::uint32_t>(k));
  }
  const auto before = [this](std::uint32_t a, std::uint32_t b) {
    return contact_key(graph_.contacts[a]) < contact_key(graph_.contacts[b]);
  };
  // Mappers append contacts in the order of time, so that they mostly are in order already.
  if (!std::is_sorted(contacts_.begin(), contacts_.end(), before))
    std::stable_sort(contacts_.begin(), contacts_.end(), before);
  for (std::size_t begin = 0, end = 0; begin < contacts_.size(); begin = end) {
    const ContactFactor& f = graph_.contacts[contacts_[begin]];
    while (end < contacts_.size() && contact_key(graph_.contacts[contacts_[end]]) == contact_key(f)) ++end;
    const ContactCost& cost = contact_costs_.emplace_back(graph_, Indices(contacts_).subspan(begin, end - begin));
    const VariableId pose = static_cast<VariableId>(f.i);
    if (graph_.touch_points[f.touch].fixed) {
      add(cost, {pose, landmark_id(f.landmark)}, Group::Contact);
    } else {
      add(cost, {pose, landmark_id(f.landmark), touch_id(f.touch)}, Group::Contact);
    }
  }
}

void ResidualBlocks::add_landmark_factors() {
  const std::vector<Landmark>& landmarks = graph_.landmarks;
  for (const SeatFactor& f : graph_.seats) {
    if (landmarks[f.landmark].active)
      add(seat_costs_.emplace_back(f), {static_cast<VariableId>(f.i), landmark_id(f.landmark)});
  }
  for (const ParallelFactor& f : graph_.parallels) {
    if (!landmarks[f.a].active || !landmarks[f.b].active) continue;
    add(parallel_costs_.emplace_back(f, landmarks[f.a].kind, landmarks[f.b].kind),
        {landmark_id(f.a), landmark_id(f.b)});
  }
  for (const LandmarkPrior& f : graph_.landmark_priors) {
    if (!landmarks[f.landmark].active) continue;
    add(landmark_prior_costs_.emplace_back(f, landmarks[f.landmark].kind), {landmark_id(f.landmark)});
  }
}

void ResidualBlocks::add_touch_priors() {
  for (std::size_t t = 0; t < graph_.touch_points.size(); ++t) {
    if (!graph_.touch_points[t].fixed) add(touch_prior_costs_.emplace_back(graph_.touch_points[t]), {touch_id(t)});
  }
}

void ResidualBlocks::add_folded() {
  for (const FoldedFactor& f : graph_.folded) {
    const Landmark& landmark = graph_.landmarks[f.landmark];
    if (!landmark.active) continue;
    const FoldedCost& cost = folded_costs_.emplace_back(f, landmark, graph_.touch_points[f.touch]);
    if (cost.with_touch()) {
      add(cost, {landmark_id(f.landmark), touch_id(f.touch)});
    } else {
      add(cost, {landmark_id(f.landmark)});
    }
  }
}

void ResidualBlocks::add(const ceres::CostFunction& cost, std::initializer_list<VariableId> variables, Group group) {
  ResidualBlock block{&cost, static_cast<int>(variables.size()), {}, {}, group};
  std::copy(variables.begin(), variables.end(), block.variables.begin());
  const std::size_t poses = values_.poses.size(), landmarks = values_.landmarks.size();
  bool free = false;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const std::size_t id = block.variables[k];
    free = free || id >= poses || id >= first_free_pose_;
    block.parameters[k] = id < poses               ? values_.poses[id].data()
                          : id < poses + landmarks ? values_.landmarks[id - poses].data()
                          : id < poses + landmarks + values_.touch_points.size()
                              ? values_.touch_points[id - poses - landmarks].data()
                              : &values_.scalars[id - poses - landmarks - values_.touch_points.size()];
  }
  (free ? blocks : constant).push_back(block);
}

VariableId ResidualBlocks::landmark_id(std::size_t landmark) const {
  return static_cast<VariableId>(values_.poses.size() + landmark);
}

VariableId ResidualBlocks::touch_id(std::size_t touch) const {
  return static_cast<VariableId>(values_.poses.size() + values_.landmarks.size() + touch);
}

VariableId ResidualBlocks::scalar_id(std::size_t scalar) const {
  return static_cast<VariableId>(values_.poses.size() + values_.landmarks.size() + values_.touch_points.size() +
                                 scalar);
}

}  // namespace kinemap::graph
