// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include "core/graph/graph.hpp"

/// Private to core/graph.
namespace kinemap::graph {

/// Folded factor (landmark) or, where it speaks of a touching point that is free, (landmark, touch).
class FoldedCost final : public ceres::CostFunction {
 public:
  FoldedCost(const FoldedFactor& factor, const Landmark& landmark, const TouchPoint& touch);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;
  [[nodiscard]] bool with_touch() const { return with_touch_; }

 private:
  const FoldedFactor& factor_;
  const Landmark& landmark_;
  bool with_touch_;
};

}  // namespace kinemap::graph
