// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/pose.hpp"

namespace kinemap {

using KeyPoseId = std::uint32_t;  ///< 0, 1, 2, … in the order of time

/// How far the suit slipped: a foot that stands neither moves nor turns, so what the stream moves it by, it moves the
/// whole body by. Differences to what the stream says.
struct Slip {
  double turn_rad = 0.0;                            ///< the pelvis turned so much more about the vertical …
  Eigen::Vector2d way_m = Eigen::Vector2d::Zero();  ///< … and went so much farther, odom frame
  double stood_s = 0.0;                             ///< for so long a foot stood and was heard
  double apart_rad = 0.0;                           ///< two standing feet differ by so much about the turn
};

/// A pose of the pelvis that becomes a node of the graph, with what the odometry noise depends on.
struct KeyPose {
  KeyPoseId id = 0;
  double time_s = 0.0;
  Pose T_odom_pelvis;
  double path_m = 0.0;    ///< length of the level pelvis path since the key pose before
  double turn_rad = 0.0;  ///< sum of |heading change| since the key pose before
  /// A break: the suit's world is another one than at the key pose before (it was restarted, or its origin was reset),
  /// or nothing is known of the way from there.
  bool discontinuity = false;
  /// Point under the ankle of the foot that carries the weight, on the sole, in the pelvis frame (m); absent in the air
  /// or when sitting.
  std::optional<Eigen::Vector3d> p_pelvis_stance;
  /// Metal bent the magnetic field at the pelvis at some time since the key pose before; absent when the suit did not
  /// say.
  std::optional<bool> field_disturbed;
  /// Since the key pose before, as the feet saw it; absent when none stood, or the suit holds standing feet in place so
  /// that they say nothing.
  std::optional<Slip> slip;
};

/// The right hand at one instant of a trace, relative to the latest key pose at or before that instant.
struct HandContact {
  double time_s = 0.0;
  KeyPoseId key_pose = 0;
  Pose T_key_hand;  ///< right-hand segment (origin: the wrist) in the key pose's pelvis frame; odometry in between
                    ///< included
};

/// All that the right hand did during one modelling gesture (left hand on the hip), lead-in and lead-out included.
struct Trace {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::optional<double> stature_m;    ///< the wearer's body height as the bone lengths of the stream give it away
  std::vector<HandContact> contacts;  ///< in order of time, thinned by distance and time
};

/// One bout of sitting.
struct Sitting {
  double begin_s = 0.0;
  double end_s = 0.0;
  KeyPoseId key_pose = 0;
  Pose T_key_seat;  ///< seat centre at seat height, level, +x where the sitter faces; in the key pose's pelvis frame
  double height_m = 0.0;  ///< seat surface over the floor under the feet
  double spread_m = 0.0;  ///< standard deviation of the seat position over the still part
};

/// A finger tip (or palm) was held on one fixed spot while the hand turned about it: a measurement of the touching
/// point.
struct Pivot {
  double begin_s = 0.0;
  double end_s = 0.0;
  Eigen::Vector3d p_hand = Eigen::Vector3d::Zero();          ///< touching point in the right-hand segment's frame, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of it, m²; wide where the turns say nothing
  std::optional<double> stature_m;                           ///< as in Trace
};

using Event = std::variant<KeyPose, Trace, Pivot, Sitting>;

}  // namespace kinemap
