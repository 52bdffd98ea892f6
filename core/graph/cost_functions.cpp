// SPDX-License-Identifier: Apache-2.0
#include "core/graph/cost_functions.hpp"

#include <algorithm>
#include <cmath>

#include "core/graph/factors.hpp"

namespace kinemap::graph {
namespace {

using Eigen::Vector3d;
using PoseRows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>>;

Pose pose_from(const double* x) { return {Vector3d(x[0], x[1], x[2]), Eigen::Quaterniond(x[6], x[3], x[4], x[5])}; }

double* jacobian(double** jacobians, int k) { return jacobians != nullptr ? jacobians[k] : nullptr; }

bool robust(const Loss& loss) { return loss.kind != Loss::Kind::None; }

/// Applies a factor's loss: the scale √ρ' for its rows; ρ − ρ'·s goes to the block's last row.
double robustify(const Loss& loss, double squared_norm, double& slack) {
  const LossValue l = evaluate(loss, squared_norm);
  slack += std::max(0.0, l.rho - l.weight * squared_norm);
  return std::sqrt(l.weight);
}

template <class Range>
bool any_robust(const Range& factors, Indices indices) {
  return std::any_of(indices.begin(), indices.end(), [&](std::uint32_t k) { return robust(factors[k].loss); });
}

}  // namespace

int rows_of(const ContactFactor& f, LandmarkKind kind) {
  if (kind == LandmarkKind::Wall) return 1;
  return 1 + (f.edge != Edge::None ? 1 : 0) + (f.corner != Edge::None ? 1 : 0);
}

BetweenCost::BetweenCost(const BetweenFactor& factor, const NoiseScales& noise)
    : factor_(factor), sqrt_information_(factor.sqrt_information) {
  sqrt_information_.leftCols<3>() /= noise.way;
  set_num_residuals(robust(factor.loss) ? 7 : 6);
  *mutable_parameter_block_sizes() = {7, 7};
}

bool BetweenCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  double* out[2] = {jacobian(jacobians, 0), jacobian(jacobians, 1)};
  Matrix6 d[2];
  const Vector6 e = between_error(pose_from(x[0]), pose_from(x[1]), factor_.T_i_j, out[0] != nullptr ? &d[0] : nullptr,
                                  out[1] != nullptr ? &d[1] : nullptr);
  const Vector6 r = sqrt_information_ * e;
  double slack = 0.0;
  const double scale = robustify(factor_.loss, r.squaredNorm(), slack);
  Eigen::Map<Vector6>{residuals} = scale * r;
  if (num_residuals() == 7) residuals[6] = std::sqrt(slack);
  for (int k = 0; k < 2; ++k) {
    if (out[k] == nullptr) continue;
    PoseRows rows(out[k], num_residuals(), 7);
    rows.setZero();
    rows.topLeftCorner<6, 6>().noalias() = (scale * sqrt_information_) * d[k];
  }
  return true;
}

CompassCost::CompassCost(const CompassFactor& factor, const NoiseScales& noise)
    : factor_(factor), sigma_(noise.heading * factor.sigma_rad) {
  set_num_residuals(1);
  if (factor.i == factor.j)
    *mutable_parameter_block_sizes() = {7, 1};
  else
    *mutable_parameter_block_sizes() = {7, 7, 1};
}

/// r = (wrap(o_j − north) − decay · wrap(o_i − north)) / sigma, o = heading_offset.
bool CompassCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const int last = factor_.i == factor_.j ? 1 : 2;
  const double north = x[last][0];
  const auto term = [&](int k, const Eigen::Quaterniond& q_odom, double weight) {
    Eigen::RowVector3d d;
    double* out = jacobian(jacobians, k);
    const double offset = heading_offset(pose_from(x[k]).q, q_odom, out != nullptr ? &d : nullptr);
    if (out != nullptr) {
      std::fill_n(out, 7, 0.0);
      Eigen::Map<Eigen::RowVector3d>{out + 3} = weight * d;
    }
    return weight * wrap_angle(offset - north);
  };
  residuals[0] = term(last - 1, factor_.q_odom_j, 1.0 / sigma_);
  if (last == 2) residuals[0] += term(0, factor_.q_odom_i, -factor_.decay / sigma_);
  if (double* out = jacobian(jacobians, last)) out[0] = (factor_.decay - 1.0) / sigma_;
  return true;
}

DriftCost::DriftCost(const DriftFactor& factor, const NoiseScales& noise)
    : factor_(factor), sigma_(noise.heading * factor.sigma_rad) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {1, 1, 1};
}

/// r = (wrap(b − a) − rate·dt) / sigma.
bool DriftCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  residuals[0] = (wrap_angle(x[1][0] - x[0][0]) - x[2][0] * factor_.dt_s) / sigma_;
  if (double* out = jacobian(jacobians, 0)) out[0] = -1.0 / sigma_;
  if (double* out = jacobian(jacobians, 1)) out[0] = 1.0 / sigma_;
  if (double* out = jacobian(jacobians, 2)) out[0] = -factor_.dt_s / sigma_;
  return true;
}

ScalarPriorCost::ScalarPriorCost(const ScalarPrior& factor, const NoiseScales& noise)
    : factor_(factor), sigma_(noise.heading * factor.sigma) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {1};
}

/// r = (x − mean) / sigma.
bool ScalarPriorCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  residuals[0] = (x[0][0] - factor_.mean) / sigma_;
  if (double* out = jacobian(jacobians, 0)) out[0] = 1.0 / sigma_;
  return true;
}

PoseCost::PoseCost(const Graph& graph, Indices gravity, Indices floors, Indices priors)
    : graph_(graph), gravity_(gravity), floors_(floors), priors_(priors) {
  const std::size_t rows = 2 * gravity.size() + floors.size() + 6 * priors.size();
  set_num_residuals(static_cast<int>(rows) + (any_robust(graph.floors, floors) ? 1 : 0));
  *mutable_parameter_block_sizes() = {7};
}

bool PoseCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const Pose T = pose_from(x[0]);
  double* out = jacobian(jacobians, 0);
  PoseRows J(out, out != nullptr ? num_residuals() : 0, 7);
  if (out != nullptr) J.setZero();
  int row = 0;
  for (const std::uint32_t k : gravity_) {
    const GravityFactor& f = graph_.gravity[k];
    Eigen::Matrix<double, 2, 6> d;
    Eigen::Map<Eigen::Vector2d>(residuals + row) = gravity_error(T, f.up, out != nullptr ? &d : nullptr) / f.sigma_rad;
    if (out != nullptr) J.block<2, 6>(row, 0) = d / f.sigma_rad;
    row += 2;
  }
  double slack = 0.0;
  for (const std::uint32_t k : floors_) {
    const FloorFactor& f = graph_.floors[k];
    Row6 d;
    const double r = floor_error(T, f.p_i, f.z, out != nullptr ? &d : nullptr) / f.sigma_m;
    const double scale = robustify(f.loss, r * r, slack);
    residuals[row] = scale * r;
    if (out != nullptr) J.block<1, 6>(row, 0) = (scale / f.sigma_m) * d;
    row += 1;
  }
  for (const std::uint32_t k : priors_) {
    const PriorFactor& f = graph_.priors[k];
    Matrix6 d;
    Eigen::Map<Vector6>(residuals + row) =
        f.sqrt_information * prior_error(T, f.T_map_i, out != nullptr ? &d : nullptr);
    if (out != nullptr) J.block<6, 6>(row, 0).noalias() = f.sqrt_information * d;
    row += 6;
  }
  if (row < num_residuals()) residuals[row] = std::sqrt(slack);
  return true;
}

ContactCost::ContactCost(const Graph& graph, Indices contacts)
    : graph_(graph),
      landmark_(graph.landmarks[graph.contacts[contacts[0]].landmark]),
      touch_(graph.touch_points[graph.contacts[contacts[0]].touch]),
      contacts_(contacts) {
  int rows = any_robust(graph.contacts, contacts) ? 1 : 0;
  for (const std::uint32_t k : contacts) rows += rows_of(graph.contacts[k], landmark_.kind);
  set_num_residuals(rows);
  *mutable_parameter_block_sizes() = {7, dimension(landmark_.kind)};
  if (!touch_.fixed) mutable_parameter_block_sizes()->push_back(3);
}

bool ContactCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const Pose T_map_i = pose_from(x[0]);
  const Eigen::Matrix3d R = T_map_i.q.toRotationMatrix();
  const Vector3d p_hand = touch_.fixed ? touch_.p_hand : Vector3d(x[2][0], x[2][1], x[2][2]);
  const Surface surface(landmark_.kind, x[1], landmark_.anchor);
  const int size = dimension(landmark_.kind);
  double* d_pose = jacobian(jacobians, 0);
  double* d_landmark = jacobian(jacobians, 1);
  double* d_touch = touch_.fixed ? nullptr : jacobian(jacobians, 2);
  // Noise at this touching point against that at the expected one, and its relative gradient.
  const double k2 = touch_.fixed ? 0.0 : touch_.turn_noise_rad_per_m * touch_.turn_noise_rad_per_m;
  const double variance = 1.0 + k2 * p_hand.squaredNorm();
  const double wider = graph_.noise.contact * std::sqrt(variance / (1.0 + k2 * touch_.prior.squaredNorm()));
  const Vector3d d_wider = k2 / variance * p_hand;
  double slack = 0.0;
  int row = 0;
  for (const std::uint32_t k : contacts_) {
    const ContactFactor& f = graph_.contacts[k];
    const Vector3d p_i = f.T_i_hand * p_hand;
    const Vector3d p_map = T_map_i.p + R * p_i;
    SurfaceError errors[3] = {surface.plane(p_map), {}, {}};
    double sigmas[3] = {f.sigma_plane_m, 0.0, 0.0};
    int rows = 1;
    if (surface.is_rectangle() && f.edge != Edge::None)
      errors[rows] = surface.side(p_map, f.edge), sigmas[rows++] = f.sigma_edge_m;
    if (surface.is_rectangle() && f.corner != Edge::None)
      errors[rows] = surface.side(p_map, f.corner), sigmas[rows++] = f.sigma_corner_m;

    double squared_norm = 0.0;
    for (double& sigma : sigmas) sigma *= wider;
    for (int m = 0; m < rows; ++m) squared_norm += errors[m].value * errors[m].value / (sigmas[m] * sigmas[m]);
    const double scale = robustify(f.loss, squared_norm, slack);
    for (int m = 0; m < rows; ++m, ++row) {
      const double weight = scale / sigmas[m];
      residuals[row] = weight * errors[m].value;
      const Vector3d g_i = weight * (R.transpose() * errors[m].d_point);  // gradient in the point, pose frame
      if (d_pose != nullptr) {
        Eigen::Map<Eigen::Matrix<double, 7, 1>> J(d_pose + 7 * row);
        J.head<3>() = g_i;
        J.segment<3>(3) = p_i.cross(g_i);
        J(6) = 0.0;
      }
      if (d_landmark != nullptr) {
        for (int c = 0; c < size; ++c)
          d_landmark[size * row + c] = weight * errors[m].d_landmark[static_cast<std::size_t>(c)];
      }
      if (d_touch != nullptr)
        Eigen::Map<Vector3d>(d_touch + 3 * row) = f.T_i_hand.q.conjugate() * g_i - residuals[row] * d_wider;
    }
  }
  if (row < num_residuals()) {
    residuals[row] = std::sqrt(slack);
    if (d_pose != nullptr) std::fill_n(d_pose + 7 * row, 7, 0.0);
    if (d_landmark != nullptr) std::fill_n(d_landmark + size * row, size, 0.0);
    if (d_touch != nullptr) std::fill_n(d_touch + 3 * row, 3, 0.0);
  }
  return true;
}

SeatCost::SeatCost(const SeatFactor& factor) : factor_(factor) {
  set_num_residuals(robust(factor.loss) ? 5 : 4);
  *mutable_parameter_block_sizes() = {7, 4};
}

bool SeatCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  double* out_pose = jacobian(jacobians, 0);
  double* out_seat = jacobian(jacobians, 1);
  Eigen::Matrix<double, 4, 6> d_i;
  Eigen::Matrix4d d_seat;
  const Eigen::Vector4d weights(1.0 / factor_.sigma_level_m, 1.0 / factor_.sigma_level_m, 1.0 / factor_.sigma_z_m,
                                1.0 / factor_.sigma_heading_rad);
  const Eigen::Vector4d r = weights.cwiseProduct(seat_error(pose_from(x[0]), x[1], factor_.T_i_seat, &d_i, &d_seat));
  double slack = 0.0;
  const double scale = robustify(factor_.loss, r.squaredNorm(), slack);
  Eigen::Map<Eigen::Vector4d>{residuals} = scale * r;
  if (num_residuals() == 5) residuals[4] = std::sqrt(slack);
  if (out_pose != nullptr) {
    PoseRows J(out_pose, num_residuals(), 7);
    J.setZero();
    J.topLeftCorner<4, 6>() = (scale * weights).asDiagonal() * d_i;
  }
  if (out_seat != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>> J(out_seat, num_residuals(), 4);
    J.setZero();
    J.topRows<4>() = (scale * weights).asDiagonal() * d_seat;
  }
  return true;
}

ParallelCost::ParallelCost(const ParallelFactor& factor, LandmarkKind a, LandmarkKind b)
    : factor_(factor), heading_a_(heading_index(a)), heading_b_(heading_index(b)) {
  set_num_residuals(robust(factor.loss) ? 2 : 1);
  *mutable_parameter_block_sizes() = {dimension(a), dimension(b)};
}

/// r = wrap(ψ_b − ψ_a − offset) / sigma.
bool ParallelCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const double r = wrap_angle(x[1][heading_b_] - x[0][heading_a_] - factor_.offset_rad) / factor_.sigma_rad;
  double slack = 0.0;
  const double scale = robustify(factor_.loss, r * r, slack);
  residuals[0] = scale * r;
  if (num_residuals() == 2) residuals[1] = std::sqrt(slack);
  const int headings[2] = {heading_a_, heading_b_};
  for (int k = 0; k < 2; ++k) {
    double* out = jacobian(jacobians, k);
    if (out == nullptr) continue;
    std::fill_n(out, num_residuals() * parameter_block_sizes()[static_cast<std::size_t>(k)], 0.0);
    out[headings[k]] = (k == 0 ? -scale : scale) / factor_.sigma_rad;
  }
  return true;
}

LandmarkPriorCost::LandmarkPriorCost(const LandmarkPrior& factor, LandmarkKind kind) : factor_(factor) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {dimension(kind)};
}

/// r = (x[index] − mean) / sigma.
bool LandmarkPriorCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  residuals[0] = (x[0][factor_.index] - factor_.mean) / factor_.sigma;
  if (double* out = jacobian(jacobians, 0)) {
    std::fill_n(out, parameter_block_sizes()[0], 0.0);
    out[factor_.index] = 1.0 / factor_.sigma;
  }
  return true;
}

TouchPriorCost::TouchPriorCost(const TouchPoint& touch) : touch_(touch) {
  set_num_residuals(3);
  *mutable_parameter_block_sizes() = {3};
}

bool TouchPriorCost::Evaluate(double const* const* x, double* residuals, double** jacobians) const {
  const Vector3d weights = touch_.sigma.cwiseInverse();
  Eigen::Map<Vector3d>{residuals} = weights.cwiseProduct(Eigen::Map<const Vector3d>(x[0]) - touch_.prior);
  if (double* out = jacobian(jacobians, 0)) Eigen::Map<Eigen::Matrix3d>{out} = weights.asDiagonal();
  return true;
}

}  // namespace kinemap::graph
