// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace kinemap {

/// First-order low-pass of a point's velocity (m/s) over stream time. The gain follows from the time between the
/// samples, so the result does not depend on the frame rate or on lost frames. Zero until two samples are known.
class SmoothedVelocity {
 public:
  explicit SmoothedVelocity(double time_constant_s) : time_constant_s_(time_constant_s) {}

  void reset() { *this = SmoothedVelocity(time_constant_s_); }
  /// Before the first sample: goes on from what another one had come to.
  void resume(const Eigen::Vector3d& velocity) { velocity_ = velocity; }
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return velocity_; }

  const Eigen::Vector3d& step(double time_s, const Eigen::Vector3d& point) {
    const double dt = time_s - time_s_;
    if (started_ && dt <= 0.0) return velocity_;
    if (started_) velocity_ += (1.0 - std::exp(-dt / time_constant_s_)) * ((point - point_) / dt - velocity_);
    started_ = true;
    time_s_ = time_s;
    point_ = point;
    return velocity_;
  }

 private:
  double time_constant_s_;
  bool started_ = false;
  double time_s_ = 0.0;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
};

/// Low-passed magnitude of a low-passed velocity, m/s: to and fro does not cancel, as it does in the velocity itself.
class SmoothedSpeed {
 public:
  SmoothedSpeed(double velocity_s, double speed_s) : velocity_(velocity_s), time_constant_s_(speed_s) {}

  void reset() {
    velocity_.reset();
    speed_ = 0.0;
    started_ = false;
  }

  double step(double time_s, const Eigen::Vector3d& point) {
    const double speed = velocity_.step(time_s, point).norm();
    if (started_ && time_s > time_s_)
      speed_ += (1.0 - std::exp(-(time_s - time_s_) / time_constant_s_)) * (speed - speed_);
    started_ = true;
    time_s_ = time_s;
    return speed_;
  }

 private:
  SmoothedVelocity velocity_;
  double time_constant_s_;
  bool started_ = false;
  double time_s_ = 0.0;
  double speed_ = 0.0;
};

/// The state after this sample: `value` keeps an active state alive up to `off` and starts one only below `on` (on ≤
/// off).
inline bool below_with_hysteresis(bool active, double value, double on, double off) {
  return value < (active ? off : on);
}

}  // namespace kinemap
