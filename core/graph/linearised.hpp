// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/graph/residual_blocks.hpp"

/// Private to core/graph.
namespace kinemap::graph {

/// One block's residuals and Jacobians, evaluated into reused memory.
class Linearised {
 public:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Strided = Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>>;

  bool evaluate(const ResidualBlock& block) {
    rows_ = block.cost->num_residuals();
    const auto& sizes = block.cost->parameter_block_sizes();
    std::size_t need = 0;
    for (const int size : sizes) need += static_cast<std::size_t>(size * rows_);
    if (memory_.size() < need) memory_.resize(need);
    residuals_.resize(static_cast<std::size_t>(rows_));
    double* next = memory_.data();
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      pointers_[k] = next;
      strides_[k] = sizes[k];
      next += sizes[k] * rows_;
    }
    return block.cost->Evaluate(block.parameters.data(), residuals_.data(), pointers_.data());
  }
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> residuals() const { return {residuals_.data(), rows_}; }
  /// The first `tangent` columns of the Jacobian in the block's k-th variable.
  [[nodiscard]] Strided jacobian(int k, int tangent) const {
    const auto i = static_cast<std::size_t>(k);
    return {pointers_[i], rows_, tangent, Eigen::OuterStride<>(strides_[i])};
  }

 private:
  int rows_ = 0;
  std::vector<double> memory_, residuals_;
  std::array<double*, 3> pointers_{};
  std::array<int, 3> strides_{};
};

}  // namespace kinemap::graph
