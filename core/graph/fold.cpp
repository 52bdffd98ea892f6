// SPDX-License-Identifier: Apache-2.0
#include "core/graph/fold.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/graph/check.hpp"
#include "core/graph/linearised.hpp"

namespace kinemap::graph {
namespace {

constexpr double kNothing = 1e-12;  // part of the largest eigenvalue: rounding, of a direction that nothing speaks of

/// ½δᵀHδ + gᵀδ + ½c on the numbers of a landmark and the touching point.
struct Quadratic {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  double c = 0.0;
  double weighted_squares = 0.0;
};

void add(const ResidualBlock& block, int first, int size, bool with_touch, const Linearised& linearised,
         Quadratic& sum) {
  const auto r = linearised.residuals();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(r.size(), sum.g.size());
  J.leftCols(size) = linearised.jacobian(first, size);
  if (with_touch && first + 1 < block.count) J.rightCols<3>() = linearised.jacobian(first + 1, 3);
  sum.H.noalias() += J.transpose() * J;
  sum.g.noalias() += J.transpose() * r;
  sum.c += r.squaredNorm();
}

FoldedFactor factor_of(const Quadratic& sum, std::size_t landmark, std::size_t touch, const Graph& graph) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sum.H);
  const double least = kNothing * solver.eigenvalues().cwiseAbs().maxCoeff();
  const auto rank = (solver.eigenvalues().array() > least).count();
  const Eigen::VectorXd roots = solver.eigenvalues().tail(rank).cwiseSqrt();
  FoldedFactor out;
  out.landmark = landmark;
  out.touch = touch;
  out.at = graph.landmarks[landmark];
  if (!graph.touch_points.empty()) out.p_hand = graph.touch_points[touch].p_hand;
  out.sqrt_information = roots.asDiagonal() * solver.eigenvectors().rightCols(rank).transpose();
  out.residual = roots.cwiseInverse().asDiagonal() * (solver.eigenvectors().rightCols(rank).transpose() * sum.g);
  out.rest = std::sqrt(std::max(0.0, sum.c - out.residual.squaredNorm()));
  out.weighted_squares = sum.weighted_squares;
  return out;
}

}  // namespace

std::optional<std::vector<FoldedFactor>> fold(Graph part) {
  part.between.clear(), part.gravity.clear(), part.floors.clear(), part.priors.clear();
  part.parallels.clear(), part.landmark_priors.clear();
  if (find_fault(part)) return std::nullopt;
  Values values(part);
  const ResidualBlocks problem(part, values, 0);
  const std::size_t poses = part.poses.size(), landmarks = part.landmarks.size();
  std::map<std::pair<std::size_t, std::size_t>, Quadratic> sums;  // by landmark and touching point
  Linearised linearised;
  for (const ResidualBlock& block : problem.blocks) {
    const int first = block.variables[0] < poses ? 1 : 0;  // the landmark's place among the variables
    const std::size_t variable = block.variables[static_cast<std::size_t>(first)];
    if (variable < poses || variable >= poses + landmarks) continue;  // the prior of a touching point
    if (!linearised.evaluate(block)) return std::nullopt;
    const std::size_t landmark = variable - poses;
    const LandmarkKind kind = part.landmarks[landmark].kind;
    const int size = dimension(kind);
    const auto after = static_cast<std::size_t>(first) + 1;
    const std::size_t touch = first + 1 < block.count ? block.variables[after] - poses - landmarks : 0;
    Quadratic& sum = sums[{landmark, touch}];
    const bool with_touch = kind != LandmarkKind::Seat && !part.touch_points[touch].fixed;
    if (sum.g.size() == 0) {
      const int columns = size + (with_touch ? 3 : 0);
      sum.H = Eigen::MatrixXd::Zero(columns, columns), sum.g = Eigen::VectorXd::Zero(columns);
    }
    add(block, first, size, with_touch, linearised, sum);
  }
  // Contacts of a fixed point have no such variable, and are all one.
  const auto free = [&part](std::size_t touch) { return part.touch_points[touch].fixed ? 0 : touch; };
  for (const ContactFactor& c : part.contacts)
    if (part.landmarks[c.landmark].active)
      sums[{c.landmark, free(c.touch)}].weighted_squares += weighted_square(part, c);
  for (const FoldedFactor& f : part.folded)
    if (part.landmarks[f.landmark].active) sums[{f.landmark, free(f.touch)}].weighted_squares += f.weighted_squares;
  std::vector<FoldedFactor> out;
  for (const auto& [of, sum] : sums) out.push_back(factor_of(sum, of.first, of.second, part));
  return out;
}

}  // namespace kinemap::graph
