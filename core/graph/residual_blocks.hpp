// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <vector>

#include "core/graph/cost_functions.hpp"
#include "core/graph/folded_cost.hpp"
#include "core/graph/graph.hpp"

/// Private to core/graph: the graph in the form that Ceres and the normal equations of Marginals both read.
///
/// One residual block per between factor, per pose (all its gravity, floor and prior factors) and per
/// pose–landmark–touch triple (all its contacts), because a solver's overhead goes with the number of blocks. Losses
/// are therefore applied factor by factor inside the block: rows and Jacobian are scaled by √ρ'(s), and one more row
/// √Σ(ρ − ρ'·s) with zero Jacobian ends the block. Then ½‖r‖² is the robust cost, Jᵀr its gradient and JᵀJ the
/// iteratively reweighted normal matrix — what Ceres does itself for losses with ρ'' ≤ 0, at a fraction of the blocks.
///
/// Pose blocks have 7 numbers (p, q as x y z w); their Jacobians have the 6 tangent columns of graph.hpp and a zero
/// one.
namespace kinemap::graph {

/// The variables of a graph as contiguous blocks of doubles.
struct Values {
  explicit Values(const Graph& graph);
  void write_to(Graph& graph) const;
  [[nodiscard]] bool all_finite() const;

  std::vector<std::array<double, 7>> poses;
  std::vector<std::array<double, 7>> landmarks;
  std::vector<std::array<double, 3>> touch_points;
  std::vector<double> scalars;
};

/// Numbers all variables of a graph: poses, then landmarks, touching points and scalars.
using VariableId = std::uint32_t;

/// What a block's factors measure.
enum class Group : std::uint8_t { Other, Heading, Contact };

struct ResidualBlock {
  const ceres::CostFunction* cost = nullptr;
  int count = 0;  ///< variables used
  std::array<VariableId, 3> variables{};
  std::array<double*, 3> parameters{};
  Group group = Group::Other;
};

/// Factor indices grouped by pose: those of pose i are items[start[i] … start[i + 1]).
struct PoseIndex {
  std::vector<std::uint32_t> start, items;
  [[nodiscard]] Indices of(std::size_t pose) const {
    return Indices(items).subspan(start[pose], start[pose + 1] - start[pose]);
  }
};

/// Σ ½‖r‖² over blocks; NaN when one cannot be evaluated.
double evaluate_cost(const std::vector<ResidualBlock>& blocks);

class ResidualBlocks {
 public:
  /// Blocks over poses, active landmarks and free touching points. `graph` (without fault, see check.hpp) and `values`
  /// must outlive this. Blocks that depend on poses below `first_free_pose` only are put aside in `constant`.
  ResidualBlocks(const Graph& graph, Values& values, std::size_t first_free_pose);
  ResidualBlocks(const ResidualBlocks&) = delete;
  ResidualBlocks& operator=(const ResidualBlocks&) = delete;

  std::vector<ResidualBlock> blocks;
  std::vector<ResidualBlock> constant;

 private:
  void add_pose_factors();
  void add_headings();
  void add_contacts();
  void add_landmark_factors();
  void add_touch_priors();
  void add_folded();
  void add(const ceres::CostFunction& cost, std::initializer_list<VariableId> variables, Group group = Group::Other);
  [[nodiscard]] VariableId landmark_id(std::size_t landmark) const;
  [[nodiscard]] VariableId touch_id(std::size_t touch) const;
  [[nodiscard]] VariableId scalar_id(std::size_t scalar) const;

  const Graph& graph_;
  Values& values_;
  std::size_t first_free_pose_;

  PoseIndex gravity_, floors_, priors_;
  std::vector<std::uint32_t> contacts_;  // sorted by pose, landmark, touching point
  // Deques: what they hold never moves, and is allocated by the page.
  std::deque<BetweenCost> between_costs_;
  std::deque<CompassCost> compass_costs_;
  std::deque<DriftCost> drift_costs_;
  std::deque<ScalarPriorCost> scalar_prior_costs_;
  std::deque<PoseCost> pose_costs_;
  std::deque<ContactCost> contact_costs_;
  std::deque<SeatCost> seat_costs_;
  std::deque<ParallelCost> parallel_costs_;
  std::deque<LandmarkPriorCost> landmark_prior_costs_;
  std::deque<TouchPriorCost> touch_prior_costs_;
  std::deque<FoldedCost> folded_costs_;
};

}  // namespace kinemap::graph
