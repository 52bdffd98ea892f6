// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <numbers>
#include <random>

#include "core/graph/so3.hpp"
#include "core/pose.hpp"

/// What the graph's tests share: seeded random values and central differences.
namespace kinemap::graph::test {

inline Pose plus(const Pose& T, const Eigen::Matrix<double, 6, 1>& delta) {
  return {T.p + T.q * delta.head<3>(), (T.q * so3_exp(delta.tail<3>())).normalized()};
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double normal(double sigma = 1.0) { return std::normal_distribution<double>(0.0, sigma)(engine_); }
  Eigen::Vector3d vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  Eigen::Vector3d noise(double sigma) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  Eigen::Vector3d direction() { return Eigen::Vector3d(normal(), normal(), normal()).normalized(); }
  /// Any rotation: |angle| uniform up to `max_angle`.
  Eigen::Quaterniond rotation(double max_angle = std::numbers::pi) {
    return so3_exp(uniform(0.0, max_angle) * direction());
  }
  Pose pose(double size = 3.0, double max_angle = std::numbers::pi) { return {vector(size), rotation(max_angle)}; }

 private:
  std::mt19937 engine_;
};

/// Central differences of f: R^n → R^m at 0, by columns.
template <class F>
Eigen::MatrixXd differentiate(const F& f, int n, double step = 1e-6) {
  Eigen::MatrixXd J;
  for (int k = 0; k < n; ++k) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(n);
    delta(k) = step;
    const Eigen::VectorXd forward = f(delta);
    delta(k) = -step;
    const Eigen::VectorXd backward = f(delta);
    if (k == 0) J.resize(forward.size(), n);
    J.col(k) = (forward - backward) / (2.0 * step);
  }
  return J;
}

/// |a − b| against the size of the larger entries: 1e-7 is what central differences of step 1e-6 can give.
inline double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

}  // namespace kinemap::graph::test
