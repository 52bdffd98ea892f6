// SPDX-License-Identifier: Apache-2.0
#include "core/graph/factors.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/graph/so3.hpp"

namespace kinemap::graph {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector6 between_error(const Pose& T_map_i, const Pose& T_map_j, const Pose& T_i_j, Matrix6* d_i, Matrix6* d_j) {
  const Matrix3d R_i_map = T_map_i.q.toRotationMatrix().transpose();
  const Matrix3d R_j_i_measured = T_i_j.q.toRotationMatrix().transpose();
  const Vector3d p_i_j = R_i_map * (T_map_j.p - T_map_i.p);
  Vector6 e;
  e.head<3>() = R_j_i_measured * (p_i_j - T_i_j.p);
  e.tail<3>() = so3_log(T_i_j.q.conjugate() * (T_map_i.q.conjugate() * T_map_j.q));
  if (d_i == nullptr && d_j == nullptr) return e;

  const Matrix3d R_i_j = R_i_map * T_map_j.q.toRotationMatrix();
  const Matrix3d jr_inv = so3_right_jacobian_inverse(e.tail<3>());
  if (d_i != nullptr) {
    d_i->topLeftCorner<3, 3>() = -R_j_i_measured;
    d_i->topRightCorner<3, 3>() = R_j_i_measured * hat(p_i_j);
    d_i->bottomLeftCorner<3, 3>().setZero();
    d_i->bottomRightCorner<3, 3>() = -jr_inv * R_i_j.transpose();
  }
  if (d_j != nullptr) {
    d_j->topLeftCorner<3, 3>() = R_j_i_measured * R_i_j;
    d_j->topRightCorner<3, 3>().setZero();
    d_j->bottomLeftCorner<3, 3>().setZero();
    d_j->bottomRightCorner<3, 3>() = jr_inv;
  }
  return e;
}

Vector6 prior_error(const Pose& T_map_i, const Pose& measured, Matrix6* d_i) {
  return between_error(Pose{}, T_map_i, measured, nullptr, d_i);
}

double heading_offset(const Eigen::Quaterniond& q_map_i, const Eigen::Quaterniond& q_odom_i, Eigen::RowVector3d* d_i) {
  const Eigen::Quaterniond q = q_map_i * q_odom_i.conjugate();
  if (d_i != nullptr) {
    const double n = std::max(1e-12, q.w() * q.w() + q.z() * q.z());  // 0: upside down against each other
    const Eigen::RowVector3d d_map((q.w() * q.y() + q.z() * q.x()) / n, (q.z() * q.y() - q.w() * q.x()) / n, 1.0);
    *d_i = d_map * q_map_i.toRotationMatrix();
  }
  return wrap_angle(2.0 * std::atan2(q.z(), q.w()));
}

Eigen::Vector2d gravity_error(const Pose& T_map_i, const Vector3d& up, Eigen::Matrix<double, 2, 6>* d_i) {
  const Matrix3d R = T_map_i.q.toRotationMatrix();
  if (d_i != nullptr) {
    d_i->leftCols<3>().setZero();
    d_i->rightCols<3>() = -R.topRows<2>() * hat(up);
  }
  return R.topRows<2>() * up;
}

double floor_error(const Pose& T_map_i, const Vector3d& p_i, double z, Row6* d_i) {
  const Matrix3d R = T_map_i.q.toRotationMatrix();
  const Vector3d up_i = R.row(2);
  if (d_i != nullptr) {
    d_i->head<3>() = up_i;
    d_i->tail<3>() = p_i.cross(up_i);
  }
  return T_map_i.p.z() + up_i.dot(p_i) - z;
}

Eigen::Vector4d seat_error(const Pose& T_map_i, const double* seat, const Pose& T_i_seat,
                           Eigen::Matrix<double, 4, 6>* d_i, Eigen::Matrix4d* d_seat) {
  const Matrix3d R = T_map_i.q.toRotationMatrix();
  const Vector3d forward_i = T_i_seat.q * Vector3d::UnitX();
  const Vector3d forward = R * forward_i;
  Eigen::Vector4d e;
  e.head<3>() = T_map_i.p + R * T_i_seat.p - Eigen::Map<const Vector3d>(seat);
  e(3) = wrap_angle(std::atan2(forward.y(), forward.x()) - seat[3]);
  if (d_i != nullptr) {
    d_i->topLeftCorner<3, 3>() = R;
    d_i->topRightCorner<3, 3>() = -R * hat(T_i_seat.p);
    d_i->bottomLeftCorner<1, 3>().setZero();
    // Gradient of atan2 in the direction; a sitter who faces straight up has no heading, and none is then inferred.
    const double level2 = forward.head<2>().squaredNorm();
    const Vector3d g =
        level2 > 1e-12 ? Vector3d(-forward.y() / level2, forward.x() / level2, 0.0) : Vector3d::Zero().eval();
    d_i->bottomRightCorner<1, 3>() = forward_i.cross(R.transpose() * g);
  }
  if (d_seat != nullptr) *d_seat = -Eigen::Matrix4d::Identity();
  return e;
}

Surface::Surface(LandmarkKind kind, const double* x, const Vector3d& anchor) : kind_(kind), x_(x) {
  const double heading = x[heading_index(kind)];
  const double c = std::cos(heading), s = std::sin(heading);
  const Vector3d level(c, s, 0.0), left(-s, c, 0.0), up = Vector3d::UnitZ();
  switch (kind) {
    case LandmarkKind::Table:
    case LandmarkKind::Seat:
      u_ = level, v_ = left, w_ = up;
      du_ = left, dv_ = -level, dw_ = Vector3d::Zero();
      break;
    case LandmarkKind::Screen:
      sin_tilt_ = std::sin(x[6]), cos_tilt_ = std::cos(x[6]);
      u_ = left, v_ = cos_tilt_ * up - sin_tilt_ * level, w_ = cos_tilt_ * level + sin_tilt_ * up;
      du_ = -level, dv_ = -sin_tilt_ * left, dw_ = cos_tilt_ * left;
      break;
    case LandmarkKind::Wall:
      u_ = left, v_ = up, w_ = level;
      du_ = -level, dv_ = Vector3d::Zero(), dw_ = left;
      origin_ = anchor + x[1] * level;
      return;
    case LandmarkKind::Direction:
      u_ = level, v_ = left, w_ = up;
      du_ = left, dv_ = -level, dw_ = Vector3d::Zero();
      origin_ = anchor;
      return;
  }
  origin_ = Vector3d(x[0], x[1], x[2]);
}

SurfaceError Surface::plane(const Vector3d& p_map) const {
  const Vector3d d = p_map - origin_;
  SurfaceError e;
  e.value = w_.dot(d);
  e.d_point = w_;
  if (kind_ == LandmarkKind::Wall) {
    // n·(p − anchor) − d with n' = u: the origin moves with the heading too, but along u ⟂ n, so n'·(p − anchor) = u·d.
    e.d_landmark[0] = u_.dot(d);
    e.d_landmark[1] = -1.0;
    return e;
  }
  Eigen::Map<Vector3d>(e.d_landmark.data()) = -w_;
  e.d_landmark[3] = dw_.dot(d);
  if (kind_ == LandmarkKind::Screen) e.d_landmark[6] = v_.dot(d);  // ∂w/∂τ = v
  return e;
}

SurfaceError Surface::side(const Vector3d& p_map, Edge edge) const {
  assert(is_rectangle() && edge != Edge::None);
  const Vector3d d = p_map - origin_;
  const bool along_u = edge == Edge::MinusU || edge == Edge::PlusU;
  const double half = edge == Edge::MinusU || edge == Edge::MinusV ? 0.5 : -0.5;
  const int size = along_u ? 4 : 5;
  const Vector3d& axis = along_u ? u_ : v_;
  SurfaceError e;
  e.value = axis.dot(d) + half * x_[size];
  e.d_point = axis;
  Eigen::Map<Vector3d>(e.d_landmark.data()) = -axis;
  e.d_landmark[3] = (along_u ? du_ : dv_).dot(d);
  e.d_landmark[size] = half;
  if (kind_ == LandmarkKind::Screen && !along_u) e.d_landmark[6] = -w_.dot(d);  // ∂v/∂τ = −w
  return e;
}

LossValue evaluate(const Loss& loss, double s) {
  const double k2 = loss.scale * loss.scale;
  switch (loss.kind) {
    case Loss::Kind::None:
      break;
    case Loss::Kind::Huber: {
      if (s <= k2) break;
      const double r = std::sqrt(s);
      return {2.0 * loss.scale * r - k2, loss.scale / r};
    }
    case Loss::Kind::Cauchy:
      return {k2 * std::log1p(s / k2), 1.0 / (1.0 + s / k2)};
  }
  return {s, 1.0};
}

}  // namespace kinemap::graph
