// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <numbers>
#include <vector>

#include "core/body.hpp"

namespace kinemap::test {

/// A jointed figure for tests: body parts are put where a posture wants them (inverse kinematics on the wearer's true
/// body), and the suit then reports them with its own idea of the body (wrong lengths, tilted segments, bent arm
/// chains).

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// What a wearer's hand does. x forward, y *outward* (to the side of the arm), z up; metres for a stature of 1.75 m,
/// scaled with it.
struct ArmSpec {
  enum class Origin {
    Hip,       ///< the hip joint of the same side, axes of the pelvis
    LevelHip,  ///< the hip joint of the same side, level axes with the pelvis's heading
    Shoulder,  ///< the shoulder joint, level axes with the pelvis's heading
  } origin = Origin::Shoulder;
  Eigen::Vector3d wrist{0.03, 0.06, -0.52};
  Eigen::Vector3d hand{0.1, 0.0, -1.0};   ///< direction from the wrist to the fingers
  Eigen::Vector3d elbow{-1.0, 0.3, 0.0};  ///< where the elbow points
};

/// One posture. Index 0 = left, 1 = right.
struct Figure {
  Eigen::Vector3d hips{0, 0,
                       0.90};  ///< hip mid-point over the floor, world; z is scaled with the stature unless hips_exact
  bool hips_exact = false;
  double heading = 0.0;
  double pelvis_pitch = 0.0;  ///< forward positive
  double pelvis_roll = 0.0;
  double trunk_pitch = 0.0;  ///< of the chest, against the vertical, forward positive
  double chest_twist = 0.0;  ///< of the chest about the spine
  /// Ankles, level axes with the pelvis's heading, from the point on the floor under the hips: forward, outward, over
  /// the sole's height.
  std::array<Eigen::Vector3d, 2> ankle{Eigen::Vector3d(0, 0.09, 0), Eigen::Vector3d(0, 0.09, 0)};
  std::array<double, 2> foot_pitch{0.0, 0.0};  ///< toes down positive
  std::array<Eigen::Vector3d, 2> knee{Eigen::Vector3d(1, 0.1, 0),
                                      Eigen::Vector3d(1, 0.1, 0)};  ///< where the knees point
  std::array<ArmSpec, 2> arm;
};

/// Error sources of the suit, each drawn once for a puppet.
struct SuitErrors {
  double body = 0.0;      ///< relative error of the segment lengths: legs one way, trunk and arms the other
  double tilt_rad = 0.0;  ///< of pelvis, trunk and legs
  double arm_rad = 0.0;   ///< of upper arm, forearm and hand, each on its own
  unsigned seed = 1;
};

/// A posture as orientations: what is blended, and what the suit measures.
struct Bones {
  Eigen::Vector3d pelvis;  ///< world, m
  std::array<Eigen::Quaterniond, kSegmentCount> q;
};

class Puppet {
 public:
  explicit Puppet(double stature_m = 1.75, const SuitErrors& errors = {});

  [[nodiscard]] Bones pose(const Figure& figure) const;
  /// What the suit reports.
  [[nodiscard]] SuitFrame report(const Bones& bones, double time_s) const;
  /// Segment origins without any error of the suit.
  [[nodiscard]] SuitFrame truth(const Bones& bones, double time_s) const;
  /// Height of the ankle joint over the sole.
  [[nodiscard]] double ankle_m() const;
  [[nodiscard]] double stature_m() const { return scale_ * 1.75; }
  /// Trunk pitch at which a figure's centre of mass is over `forward_m` before its hips (a coarse five-part model of
  /// the masses, not the tracker's).
  [[nodiscard]] Figure balanced(Figure figure, double forward_m) const;

 private:
  using Offsets = std::array<Eigen::Vector3d, kSegmentCount>;
  [[nodiscard]] SuitFrame chain(const Bones& bones, const Offsets& offsets) const;

  double scale_;
  Offsets true_;
  Offsets suit_;
  std::array<Eigen::Quaterniond, kSegmentCount> error_;
};

Bones blend(const Bones& a, const Bones& b, double share);

/// A piece of a performance: `figure(t)`, t counted from its begin.
struct Act {
  double duration_s;
  std::function<Figure(double)> figure;
};

struct Sampling {
  double rate_hz = 120.0;
  double loss = 0.0;  ///< share of the frames that never arrive
  unsigned seed = 1;
  double blend_s = 0.8;  ///< time of the change from one act to the next
};

/// The frames of a performance, as the suit reports them.
std::vector<SuitFrame> perform(const Puppet& puppet, const std::vector<Act>& acts, const Sampling& sampling = {});

}  // namespace kinemap::test
