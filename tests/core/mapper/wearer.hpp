// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/mapper/mapper.hpp"

/// A point-like wearer for the tests of the mapper: it makes the events directly (no body, no gait) from true
/// positions, through an odometry whose heading drifts steadily. What touches is `touch_m` along −y of the hand.
namespace kinemap::test {

class Wearer {
 public:
  explicit Wearer(double heading_drift_rad_per_s = 0.0, std::uint32_t seed = 1)
      : drift_(heading_drift_rad_per_s), random_(seed) {
    key_pose();
  }

  /// Straight to (x, y) at 1 m/s.
  void walk_to(double x, double y) {
    const Eigen::Vector2d from = true_.p.head<2>(), to(x, y);
    const double length = (to - from).norm();
    const int n = std::max(1, static_cast<int>(length / 0.2));
    for (int i = 1; i <= n; ++i) {
      const Eigen::Vector2d p = from + (to - from) * (static_cast<double>(i) / n);
      move({p.x(), p.y(), 0.95}, std::atan2(to.y() - from.y(), to.x() - from.x()), length / n);
      key_pose();
    }
  }

  /// The right hand along a polyline (true map, m) at 0.4 m/s, the body `away` from it towards `stand(p)`.
  void trace(const std::vector<Eigen::Vector3d>& polyline, const Eigen::Vector2d& stand) {
    Trace out;
    out.begin_s = time_;
    out.stature_m = stature_m;
    std::normal_distribution<double> noise(0.0, 0.004);
    for (std::size_t k = 1; k < polyline.size(); ++k) {
      const Eigen::Vector3d leg = polyline[k] - polyline[k - 1];
      const int n = std::max(1, static_cast<int>(leg.norm() / 0.02));
      for (int i = 0; i < n; ++i) {
        const Eigen::Vector3d tip = polyline[k - 1] + leg * (static_cast<double>(i) / n);
        const Eigen::Vector2d off = (stand - tip.head<2>()).normalized() * 0.6;
        move({tip.x() + off.x(), tip.y() + off.y(), 0.95}, std::atan2(-off.y(), -off.x()), leg.norm() / n / 0.4);
        if (time_ - key_poses_.back().time_s >= 1.0 || moved() >= 0.2) key_pose();
        const Pose T_true_key = true_at_key_;
        Pose T_key_hand{T_true_key.inverse() * tip, Eigen::Quaterniond::Identity()};
        T_key_hand.p += Eigen::Vector3d(noise(random_), touch_m + noise(random_), noise(random_));
        out.contacts.push_back({time_, key_poses_.back().id, T_key_hand});
      }
    }
    out.end_s = time_;
    events.emplace_back(std::move(out));
  }

  void sit(double x, double y, double heading) {
    walk_to(x + 0.2 * std::cos(heading), y + 0.2 * std::sin(heading));
    key_pose();
    Sitting out;
    out.begin_s = time_;
    out.end_s = time_ += 4.0;
    out.key_pose = key_poses_.back().id;
    out.T_key_seat = true_at_key_.inverse() * level_pose({x, y, 0.45}, heading);
    out.height_m = 0.45;
    out.spread_m = 0.01;
    events.emplace_back(out);
  }

  /// The suit is started anew after so many seconds: its world begins where the wearer is, in a heading of its own.
  void restart(double seconds, double heading) {
    time_ += seconds;
    odom_ = level_pose({0.0, 0.0, 0.95}, heading);
    key_pose(true);
  }

  /// The touching point is held on a spot and the hand turned about it.
  void pivot(double sigma_m) {
    events.emplace_back(
        Pivot{time_, time_ + 6.0, {0.0, -touch_m, 0.0}, Eigen::Matrix3d::Identity() * sigma_m * sigma_m, stature_m});
    time_ += 6.0;
  }

  double touch_m = 0.18;
  std::optional<double> stature_m;
  std::vector<Event> events;
  std::vector<Pose> truth;  ///< T_map_pelvis of each key pose

 private:
  void move(const Eigen::Vector3d& p, double heading, double seconds) {
    const Pose next = level_pose(p, heading);
    const Pose step = true_.inverse() * next;
    odom_ = odom_ * step;
    odom_.q = Eigen::AngleAxisd(drift_ * seconds, Eigen::Vector3d::UnitZ()) * odom_.q;
    path_ += step.p.head<2>().norm();
    turn_ += std::abs(wrap_angle(heading_of(step.q)));
    true_ = next;
    time_ += seconds;
  }
  [[nodiscard]] double moved() const { return path_; }
  void key_pose(bool discontinuity = false) {
    KeyPose k;
    k.discontinuity = discontinuity;
    k.id = static_cast<KeyPoseId>(key_poses_.size());
    k.time_s = time_;
    k.T_odom_pelvis = odom_;
    k.path_m = path_;
    k.turn_rad = turn_;
    k.p_pelvis_stance = Eigen::Vector3d(0.0, 0.1, -0.95);
    path_ = turn_ = 0.0;
    true_at_key_ = true_;
    key_poses_.push_back(k);
    truth.push_back(true_);
    events.emplace_back(k);
  }

  double drift_;
  std::mt19937 random_;
  double time_ = 0.0, path_ = 0.0, turn_ = 0.0;
  Pose true_ = level_pose({0.0, 0.0, 0.95}, 0.0), odom_ = true_, true_at_key_ = true_;
  std::vector<KeyPose> key_poses_;
};

}  // namespace kinemap::test
