// SPDX-License-Identifier: Apache-2.0
#include "core/graph/optimizer.hpp"

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/graph/check.hpp"
#include "core/graph/residual_blocks.hpp"
#include "core/graph/so3.hpp"

#ifdef KINEMAP_OPENBLAS
extern "C" void openblas_set_num_threads(int);  // its header's name and place differ between distributions
#endif

namespace kinemap::graph {
namespace {

/// T ⊞ δ as in graph.hpp. The cost functions write Jacobians by the tangent into the first six of seven columns, so
/// this maps those through unchanged: PlusJacobian = [I₆; 0]. (Every cost on a pose block must therefore be one of
/// ours.)
class PoseManifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Quaterniond q(x[6], x[3], x[4], x[5]);
    Eigen::Map<Eigen::Vector3d>{x_plus_delta} =
        Eigen::Vector3d(x[0], x[1], x[2]) + q * Eigen::Map<const Eigen::Vector3d>(delta);
    Eigen::Map<Eigen::Quaterniond>{x_plus_delta + 3} =
        (q * so3_exp(Eigen::Map<const Eigen::Vector3d>(delta + 3))).normalized();
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Eigen::Quaterniond q_inv(x[6], -x[3], -x[4], -x[5]), q_y(y[6], y[3], y[4], y[5]);
    Eigen::Map<Eigen::Vector3d>{y_minus_x} =
        q_inv * (Eigen::Map<const Eigen::Vector3d>(y) - Eigen::Map<const Eigen::Vector3d>(x));
    Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} = so3_log(q_inv * q_y);
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

/// Once per process: Ceres' log (glog writes to stderr unless told otherwise; what went wrong is in the verdict) and
/// the BLAS' threads (more than one is slower at this size, and sums in another order).
void quieten_libraries() {
  [[maybe_unused]] static const bool once = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
#ifdef KINEMAP_OPENBLAS
    openblas_set_num_threads(1);
#endif
    return true;
  }();
}

std::size_t first_free(const Graph& graph, const OptimizerOptions& options) {
  const std::size_t gauge = graph.priors.empty() ? 1 : 0;
  return std::min(std::max({options.first_free_pose, graph.first_free_pose, gauge}), graph.poses.size());
}

void fill_problem(const ResidualBlocks& blocks, Values& values, std::size_t first_free_pose, ceres::Manifold& manifold,
                  ceres::Problem& problem) {
  std::vector<bool> used(values.poses.size(), false);
  for (const ResidualBlock& block : blocks.blocks) {
    for (int k = 0; k < block.count; ++k) {
      if (block.variables[static_cast<std::size_t>(k)] < used.size())
        used[block.variables[static_cast<std::size_t>(k)]] = true;
    }
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    problem.AddParameterBlock(values.poses[i].data(), 7, &manifold);
    if (i < first_free_pose) problem.SetParameterBlockConstant(values.poses[i].data());
  }
  for (const ResidualBlock& block : blocks.blocks) {
    // The problem does not own cost functions, so that nothing is written through this pointer.
    problem.AddResidualBlock(const_cast<ceres::CostFunction*>(block.cost), nullptr, block.parameters.data(),
                             block.count);
  }
}

ceres::Solver::Options solver_options(const OptimizerOptions& options, double radius) {
  ceres::Solver::Options s;
  s.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  s.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  s.dynamic_sparsity = false;
  s.jacobi_scaling = false;
  s.num_threads = 1;  // bit-reproducible, and no slower at this size
  s.max_num_iterations = options.max_iterations;
  s.function_tolerance = options.function_tolerance;
  s.initial_trust_region_radius = radius;
  s.max_trust_region_radius = std::max(radius, s.max_trust_region_radius);
  if (options.time_budget_s > 0.0) s.max_solver_time_in_seconds = options.time_budget_s;
  s.logging_type = ceres::SILENT;
  return s;
}

Verdict solve(const Graph& graph, const OptimizerOptions& options, double radius, Values& values) {
  const std::size_t first_free_pose = first_free(graph, options);
  ResidualBlocks blocks(graph, values, first_free_pose);
  const double constant_cost = evaluate_cost(blocks.constant);
  PoseManifold manifold;
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  fill_problem(blocks, values, first_free_pose, manifold, problem);

  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options, radius), &problem, &summary);
  Verdict verdict;
  verdict.initial_cost = summary.initial_cost + constant_cost;
  verdict.final_cost = summary.final_cost + constant_cost;
  verdict.converged = summary.termination_type == ceres::CONVERGENCE;
  verdict.iterations = std::max(0, summary.num_successful_steps + summary.num_unsuccessful_steps - 1);
  verdict.seconds = summary.total_time_in_seconds;
  verdict.message = summary.message;
  verdict.usable = summary.IsSolutionUsable() && std::isfinite(verdict.final_cost) &&
                   verdict.final_cost <= verdict.initial_cost && values.all_finite();
  return verdict;
}

}  // namespace

Verdict optimize(Graph& graph, const OptimizerOptions& options) {
  quieten_libraries();
  if (const auto fault = find_fault(graph)) {
    Verdict verdict;
    verdict.initial_cost = verdict.final_cost = std::numeric_limits<double>::quiet_NaN();
    verdict.message = *fault;
    return verdict;
  }
  constexpr double kDampedRadius = 1e4;
  Values values(graph);
  Verdict verdict = solve(graph, options, options.initial_trust_region_radius, values);
  if (!verdict.usable && options.initial_trust_region_radius > kDampedRadius) {
    values = Values(graph);
    const double seconds = verdict.seconds;
    verdict = solve(graph, options, kDampedRadius, values);
    verdict.seconds += seconds;
  }
  if (verdict.usable) values.write_to(graph);
  return verdict;
}

double cost(const Graph& graph) {
  if (find_fault(graph)) return std::numeric_limits<double>::quiet_NaN();
  Values values(graph);
  return evaluate_cost(ResidualBlocks(graph, values, 0).blocks);
}

}  // namespace kinemap::graph
