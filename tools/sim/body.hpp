// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tools/sim/geometry.hpp"
#include "tools/sim/random.hpp"

namespace kinemap::sim {

/// MVN's 23 segments in stream order (segment id − 1).
enum Bone : std::uint8_t {
  kPelvis,
  kL5,
  kL3,
  kT12,
  kT8,
  kNeck,
  kHead,
  kRightShoulder,
  kRightUpperArm,
  kRightForearm,
  kRightHand,
  kLeftShoulder,
  kLeftUpperArm,
  kLeftForearm,
  kLeftHand,
  kRightUpperLeg,
  kRightLowerLeg,
  kRightFoot,
  kRightToe,
  kLeftUpperLeg,
  kLeftLowerLeg,
  kLeftFoot,
  kLeftToe,
};
inline constexpr std::size_t kBones = 23;
inline constexpr std::array<int, kBones> kParent{-1, 0,  1,  2, 3,  4,  5,  4, 7,  8,  9, 4,
                                                 11, 12, 13, 0, 15, 16, 17, 0, 19, 20, 21};
const char* bone_name(std::size_t bone);

enum class Side : std::uint8_t { Right, Left };
inline double lateral(Side side) { return side == Side::Left ? 1.0 : -1.0; }  ///< sign along the body's y axis

/// A body's dimensions: each joint seen from its parent's joint in the T-pose (x forward, y left, z up; m).
/// Segment frames are all aligned with the world in the T-pose, arms along ±y, palms down.
struct Body {
  double stature = 1.75;
  std::array<Vec3, kBones> offset;
  double ankle_height = 0.07;  ///< over the sole
  double ball_height = 0.02;

  [[nodiscard]] double thigh(Side s) const { return offset[s == Side::Right ? kRightLowerLeg : kLeftLowerLeg].norm(); }
  [[nodiscard]] double shank(Side s) const { return offset[s == Side::Right ? kRightFoot : kLeftFoot].norm(); }
  [[nodiscard]] double upper_arm(Side s) const {
    return offset[s == Side::Right ? kRightForearm : kLeftForearm].norm();
  }
  [[nodiscard]] double forearm(Side s) const { return offset[s == Side::Right ? kRightHand : kLeftHand].norm(); }
  [[nodiscard]] double hip_height() const { return thigh(Side::Right) + shank(Side::Right) + ankle_height; }
};

/// Proportions of an average adult of this stature (after Drillis and Contini's table), each varied by some per cent.
Body make_body(double stature_m, Random& random);

/// `body` as somebody with a tape measure entered it: every bone wrong by a few per cent, left and right alike.
Body mismeasured(const Body& body, double sigma, Random& random);

using Pose23 = std::array<Placed, kBones>;

/// Positions of every joint from the pelvis position and all orientations.
void forward_kinematics(const Body& body, Pose23& pose);
/// The same for one chain only: from `first` (its parent already placed) to `last`, consecutive indices.
void place_chain(const Body& body, Pose23& pose, std::size_t first, std::size_t last);

}  // namespace kinemap::sim
