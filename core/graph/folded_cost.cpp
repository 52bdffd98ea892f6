// SPDX-License-Identifier: Apache-2.0
#include "core/graph/folded_cost.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/graph/factors.hpp"

namespace kinemap::graph {
namespace {

using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 7, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7>;

/// The landmark's numbers `x` as the factor calls them, less what they were then; `d` is its Jacobian in `x`. A wall
/// has its offset from another anchor, a table may have its axes named the other way round.
Numbers change(const FoldedFactor& factor, const Landmark& landmark, const double* x, Square& d) {
  const LandmarkKind kind = landmark.kind;
  const int size = dimension(kind), heading = heading_index(kind);
  Numbers now = Eigen::Map<const Eigen::VectorXd>(x, size);
  d = Square::Identity(size, size);
  if (kind == LandmarkKind::Wall) {
    const Eigen::Vector3d shift = landmark.anchor - factor.at.anchor;
    const double c = std::cos(x[0]), s = std::sin(x[0]);
    now[1] += c * shift.x() + s * shift.y();
    d(1, 0) = -s * shift.x() + c * shift.y();
  }
  if (kind == LandmarkKind::Table) {
    now[heading] += factor.quarter_turns * std::numbers::pi / 2.0;
    if (factor.quarter_turns % 2 != 0) {
      std::swap(now[4], now[5]);
      d.row(4).swap(d.row(5));
    }
  }
  now -= Eigen::Map<const Eigen::VectorXd>(factor.at.x.data(), size);
  now[heading] = wrap_angle(now[heading]);
  return now;
}

}  // namespace

FoldedCost::FoldedCost(const FoldedFactor& factor, const Landmark& landmark, const TouchPoint& touch)
    : factor_(factor),
      landmark_(landmark),
      with_touch_(!touch.fixed && factor.sqrt_information.cols() > dimension(landmark.kind)) {
  set_num_residuals(static_cast<int>(factor.residual.size()) + 1);
  *mutable_parameter_block_sizes() = {dimension(landmark.kind)};
  if (with_touch_) mutable_parameter_block_sizes()->push_back(3);
}

bool FoldedCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int size = dimension(landmark_.kind);
  const auto rows = factor_.residual.size();
  const auto of_numbers = factor_.sqrt_information.leftCols(size);
  Square d;
  Eigen::Map<Eigen::VectorXd> r(residuals, rows);
  r = factor_.residual + of_numbers * change(factor_, landmark_, x[0], d);
  if (with_touch_)
    r += factor_.sqrt_information.rightCols<3>() * (Eigen::Map<const Eigen::Vector3d>(x[1]) - factor_.p_hand);
  residuals[rows] = factor_.rest;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<RowMajor> J(jacobians[0], rows + 1, size);
    J.topRows(rows) = of_numbers * d;
    J.bottomRows<1>().setZero();
  }
  if (with_touch_ && jacobians[1] != nullptr) {
    Eigen::Map<RowMajor> J(jacobians[1], rows + 1, 3);
    J.topRows(rows) = factor_.sqrt_information.rightCols<3>();
    J.bottomRows<1>().setZero();
  }
  return true;
}

}  // namespace kinemap::graph
