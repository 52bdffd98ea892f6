// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/pose.hpp"

namespace kinemap {

/// The 23 body segments of MVN, in stream order (index = MVN segment id − 1). A segment's origin is its proximal joint:
/// Pelvis = mid-point of the hips, UpperLeg = hip, LowerLeg = knee, Foot = ankle, UpperArm = shoulder, Forearm = elbow,
/// Hand = wrist. All segment frames are aligned with the world (x forward, y left, z up) in the T-pose, so the right
/// arm and hand point along their local −y, the left ones along +y, legs along −z, feet along +x.
enum class Segment : std::uint8_t {
  Pelvis,
  L5,
  L3,
  T12,
  T8,
  Neck,
  Head,
  RightShoulder,
  RightUpperArm,
  RightForearm,
  RightHand,
  LeftShoulder,
  LeftUpperArm,
  LeftForearm,
  LeftHand,
  RightUpperLeg,
  RightLowerLeg,
  RightFoot,
  RightToe,
  LeftUpperLeg,
  LeftLowerLeg,
  LeftFoot,
  LeftToe,
};
inline constexpr std::size_t kSegmentCount = 23;

/// The earth's magnetic field as one sensor of the suit has it. Metal nearby bends it, and the heading with it. What it
/// is far from metal depends on the place on earth: judge by the difference to what it usually is in this recording.
struct MagneticField {
  double norm = 1.0;  ///< strength, 1: as where the suit's sensors were calibrated
  double dip = 0.0;   ///< below the horizontal, rad, −π/2 … π/2
};

/// One whole, checked sample of one wearer. All poses are `T_odom_segment`: the suit's world frame (z up, metres),
/// which drifts.
struct SuitFrame {
  double time_s = 0.0;      ///< stream time since the first frame of this wearer; never decreases
  std::uint64_t index = 0;  ///< sample counter, unwrapped; gaps are lost samples
  /// The sender's counter and time of day as they came (0: it has none); they tell its stream from another one.
  std::uint32_t counter = 0, time_code_ms = 0;
  /// First frame after a restart of the suit, a reset of its origin or a change of the body: no odometry from the frame
  /// before.
  bool discontinuity = false;
  std::array<Pose, kSegmentCount> segments;
  std::optional<Eigen::Vector3d> center_of_mass;  ///< odom frame, m; only when the suit streams type 24

  /// At the sensors of the pelvis and of the right forearm; only when the suit streams type 23.
  std::optional<MagneticField> field_pelvis, field_right_forearm;

  [[nodiscard]] const Pose& operator[](Segment s) const { return segments[static_cast<std::size_t>(s)]; }
  Pose& operator[](Segment s) { return segments[static_cast<std::size_t>(s)]; }
};

/// What is known of a wearer beyond the poses (MXTP types 12 and 13, MVNX points). Absent means unknown.
struct WearerInfo {
  std::string name;
  std::optional<Eigen::Vector3d> p_hand_fingertip;  ///< right finger tip in the right-hand segment frame, m
  std::optional<Eigen::Vector3d> p_hand_palm;       ///< middle of the right palm in the right-hand segment frame, m
  std::optional<double> stature_m;                  ///< body height
};

}  // namespace kinemap
