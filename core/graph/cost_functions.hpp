// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <cstdint>
#include <span>

#include "core/graph/graph.hpp"

/// Private to core/graph: the factors as Ceres cost functions, whitened and robustified as residual_blocks.hpp
/// describes.
namespace kinemap::graph {

using Indices = std::span<const std::uint32_t>;

/// Number of residuals of a contact.
int rows_of(const ContactFactor& f, LandmarkKind kind);

/// Between factor (poses i, j).
class BetweenCost final : public ceres::CostFunction {
 public:
  BetweenCost(const BetweenFactor& factor, const NoiseScales& noise);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const BetweenFactor& factor_;
  Matrix6 sqrt_information_;
};

/// Compass factor (poses i, j, north), or (pose j, north) when i = j.
class CompassCost final : public ceres::CostFunction {
 public:
  CompassCost(const CompassFactor& factor, const NoiseScales& noise);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const CompassFactor& factor_;
  double sigma_;
};

/// Drift factor (scalars a, b, rate).
class DriftCost final : public ceres::CostFunction {
 public:
  DriftCost(const DriftFactor& factor, const NoiseScales& noise);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const DriftFactor& factor_;
  double sigma_;
};

/// Prior on a scalar.
class ScalarPriorCost final : public ceres::CostFunction {
 public:
  ScalarPriorCost(const ScalarPrior& factor, const NoiseScales& noise);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const ScalarPrior& factor_;
  double sigma_;
};

/// All factors on one pose alone: gravity, floors, priors.
class PoseCost final : public ceres::CostFunction {
 public:
  PoseCost(const Graph& graph, Indices gravity, Indices floors, Indices priors);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Graph& graph_;
  Indices gravity_, floors_, priors_;
};

/// All contacts made from one pose with one landmark at one touching point: (pose, landmark) or, when the point is
/// free, (pose, landmark, touch).
class ContactCost final : public ceres::CostFunction {
 public:
  ContactCost(const Graph& graph, Indices contacts);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Graph& graph_;
  const Landmark& landmark_;
  const TouchPoint& touch_;
  Indices contacts_;
};

/// Seat factor (pose, landmark).
class SeatCost final : public ceres::CostFunction {
 public:
  explicit SeatCost(const SeatFactor& factor);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const SeatFactor& factor_;
};

/// Parallel factor (landmarks a, b).
class ParallelCost final : public ceres::CostFunction {
 public:
  ParallelCost(const ParallelFactor& factor, LandmarkKind a, LandmarkKind b);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const ParallelFactor& factor_;
  int heading_a_, heading_b_;
};

/// Prior on one number of a landmark.
class LandmarkPriorCost final : public ceres::CostFunction {
 public:
  LandmarkPriorCost(const LandmarkPrior& factor, LandmarkKind kind);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const LandmarkPrior& factor_;
};

/// Prior on a free touching point: (p_hand − prior) / sigma by components.
class TouchPriorCost final : public ceres::CostFunction {
 public:
  explicit TouchPriorCost(const TouchPoint& touch);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const TouchPoint& touch_;
};

}  // namespace kinemap::graph
