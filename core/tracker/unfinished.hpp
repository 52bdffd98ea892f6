// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/events.hpp"

/// What a tracker is in the middle of, so that another one can go on with it when the computer fails in between. A
/// gesture is told piece by piece: each piece has what changed, and what was added since the piece before.
namespace kinemap {

/// Whether a hand lies on the hip. `held` implies `near`. A hand is near as soon as the arm has the shape of the
/// gesture, and held once it has rested there.
struct HipState {
  bool near = false;
  bool held = false;
  double rests_since_s = 0.0;  ///< stream time; of use while held
};

/// Of a Trace that is being drawn.
struct UnfinishedTrace {
  double begin_s = 0.0;
  double seen_s = 0.0;                ///< last frame with the gesture
  bool held = false;                  ///< by now it is sure that the gesture is meant
  std::array<HipState, 2> hips;       ///< left, right
  std::optional<double> stature_m;    ///< as in Trace
  std::vector<HandContact> contacts;  ///< since the piece before
};

/// The seat at one instant of sitting.
struct SeatSample {
  double time_s = 0.0;
  KeyPoseId key_pose = 0;
  Pose T_key_seat;  ///< as in Sitting
  double height_m = 0.0;
};

/// Of a Sitting that goes on.
struct UnfinishedSitting {
  double begin_s = 0.0;
  double seen_s = 0.0;         ///< last frame in which the legs sat
  double still_s = 0.0;        ///< time sat still
  double unsupported_s = 0.0;  ///< of which with the centre of mass outside of the feet
  bool still = false;
  bool outside = false;                                ///< the centre of mass is there now
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the pelvis, smoothed, m/s
  std::vector<SeatSample> samples;                     ///< since the piece before
};

/// Puts the next piece to the ones before; one of another gesture takes their place.
void append(std::optional<UnfinishedTrace>& whole, UnfinishedTrace piece);
void append(std::optional<UnfinishedSitting>& whole, UnfinishedSitting piece);

/// Where the wearer is, and the way there since the latest key pose (as in KeyPose).
struct SinceKeyPose {
  Pose T_odom_pelvis;
  double path_m = 0.0;
  double turn_rad = 0.0;
};

/// What is known of a tracker that is gone.
struct Interrupted {
  std::vector<KeyPose> key_poses;  ///< the last one, before it all that what is unfinished refers to; never empty
  std::optional<SinceKeyPose> since_key_pose;  ///< the last one
  std::optional<UnfinishedTrace> trace;
  std::optional<UnfinishedSitting> sitting;

  /// nullptr when it is not among `key_poses`.
  [[nodiscard]] const KeyPose* find(KeyPoseId id) const;
};

}  // namespace kinemap
