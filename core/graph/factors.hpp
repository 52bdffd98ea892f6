// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/graph/graph.hpp"

/// The residuals of the graph as pure functions, each with its Jacobian in the tangent of graph.hpp. Errors are not
/// whitened (metres, radians) but for the function's documented exceptions; a null Jacobian pointer means "not wanted".
/// No Ceres here.
namespace kinemap::graph {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Row6 = Eigen::Matrix<double, 1, 6>;

/// Paper eq. 1: e = [R_ijᵀ (R_iᵀ (p_j − p_i) − p_ij); log(q_ij⁻¹ q_i⁻¹ q_j)].
Vector6 between_error(const Pose& T_map_i, const Pose& T_map_j, const Pose& T_i_j, Matrix6* d_i, Matrix6* d_j);

/// e = between_error(identity, T_map_i, measured): [R_mᵀ (p_i − p_m); log(q_m⁻¹ q_i)].
Vector6 prior_error(const Pose& T_map_i, const Pose& measured, Matrix6* d_i);

/// How far pose i is turned about the vertical from where odometry has it: the turn about z, rad, that is left of
/// q_map_i·q_odom_i⁻¹ without its tilt (swing-twist decomposition). `d_i` is in the tangent of the pose's rotation.
double heading_offset(const Eigen::Quaterniond& q_map_i, const Eigen::Quaterniond& q_odom_i,
                      Eigen::RowVector3d* d_i = nullptr);

/// e = the level part (x, y) of R_map_i·up; for small tilts the tilt in rad.
Eigen::Vector2d gravity_error(const Pose& T_map_i, const Eigen::Vector3d& up, Eigen::Matrix<double, 2, 6>* d_i);

/// e = (T_map_i·p_i).z − z.
double floor_error(const Pose& T_map_i, const Eigen::Vector3d& p_i, double z, Row6* d_i);

/// Paper eq. 3 for seats: e = [T_map_i·p_i_seat − p_seat (map axes); wrap(heading(R_map_i·R_i_seat) − ψ)], seat = (x,
/// y, z, ψ).
Eigen::Vector4d seat_error(const Pose& T_map_i, const double* seat, const Pose& T_i_seat,
                           Eigen::Matrix<double, 4, 6>* d_i, Eigen::Matrix4d* d_seat);

/// One scalar error of a touched point with its gradients in the map-frame point and in the landmark's numbers.
struct SurfaceError {
  double value = 0.0;  ///< m
  Eigen::Vector3d d_point = Eigen::Vector3d::Zero();
  std::array<double, 7> d_landmark{};
};

/// A landmark's surface at fixed numbers, prepared once (sines and cosines) for many contacts.
class Surface {
 public:
  /// `x` points to dimension(kind) numbers.
  Surface(LandmarkKind kind, const double* x, const Eigen::Vector3d& anchor);

  /// Paper eq. 4: signed distance of the point to the landmark's plane along its normal w. Wall: n·(p − anchor) − d;
  /// others: w·(p − centre).
  [[nodiscard]] SurfaceError plane(const Eigen::Vector3d& p_map) const;

  /// Distance along u or v to one side of a rectangle: u·(p − centre) ± length/2 or v·(p − centre) ± width/2. `edge` is
  /// not None, kind is Table or Screen.
  [[nodiscard]] SurfaceError side(const Eigen::Vector3d& p_map, Edge edge) const;

  [[nodiscard]] bool is_rectangle() const { return kind_ == LandmarkKind::Table || kind_ == LandmarkKind::Screen; }
  [[nodiscard]] const Eigen::Vector3d& u() const { return u_; }
  [[nodiscard]] const Eigen::Vector3d& v() const { return v_; }
  [[nodiscard]] const Eigen::Vector3d& w() const { return w_; }
  /// Centre; for a wall the foot of the perpendicular from its anchor.
  [[nodiscard]] const Eigen::Vector3d& origin() const { return origin_; }

 private:
  LandmarkKind kind_;
  const double* x_;
  Eigen::Vector3d u_, v_, w_, origin_;
  Eigen::Vector3d du_, dv_, dw_;  // derivatives in the heading
  double sin_tilt_ = 0.0, cos_tilt_ = 1.0;
};

/// Index of the heading among a landmark's numbers.
constexpr int heading_index(LandmarkKind kind) {
  return kind == LandmarkKind::Wall || kind == LandmarkKind::Direction ? 0 : 3;
}

/// Value and derivative of a robust loss at the squared norm s: ρ(s), ρ'(s).
struct LossValue {
  double rho = 0.0;
  double weight = 1.0;
};
LossValue evaluate(const Loss& loss, double squared_norm);

}  // namespace kinemap::graph
