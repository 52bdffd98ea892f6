// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/pose_covariance.hpp"

#include <cmath>

namespace kinemap {
namespace {

using graph::Matrix6;

/// Turns a covariance in a pose's own axes into the map's.
Matrix6 in_map_axes(const Eigen::Quaterniond& q, const Matrix6& covariance) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = q.toRotationMatrix();
  return turn * covariance * turn.transpose();
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace

void PoseCovariance::set(const Pose& T_map_pelvis, const Matrix6& marginal) {
  covariance_ = in_map_axes(T_map_pelvis.q, marginal);
}

void PoseCovariance::add(const Pose& T_map_i, const Pose& T_i_j, const StepSigma& step) {
  const Pose T_map_j = T_map_i * T_i_j;
  // Of x, y and heading only, and these about the map's z: what the wearer leans is small against what is unknown here.
  Matrix6 noise = Matrix6::Zero();
  noise.diagonal() << step.level_m, step.level_m, 0.0, 0.0, 0.0, step.heading_rad;
  noise = noise.cwiseAbs2().eval();

  // p_j = p_i + R_i t: an error of the heading at i turns the way to j.
  Matrix6 carry = Matrix6::Identity();
  carry.block<2, 1>(0, 5) = -cross_matrix(T_map_j.p - T_map_i.p).block<2, 1>(0, 2);
  covariance_ = carry * covariance_ * carry.transpose() + noise;
}

Matrix6 PoseCovariance::published(const Pose& T_map_pelvis, const Eigen::Vector3d& p_first, double way) const {
  Matrix6 out = covariance_;
  const Eigen::Vector2d scaled = way * config_.scale_sigma * (T_map_pelvis.p - p_first).head<2>();
  out.topLeftCorner<2, 2>() += scaled * scaled.transpose();
  return 0.5 * (out + out.transpose());  // symmetric to the bit
}

Matrix6 newest_marginal(const graph::Graph& graph, const graph::Marginals& marginals) {
  const graph::Variable newest{graph::Variable::Kind::Pose, graph.poses.size() - 1};
  return marginals.joint({&newest, 1});
}

}  // namespace kinemap
