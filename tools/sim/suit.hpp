// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "tools/sim/drift.hpp"
#include "tools/sim/performer.hpp"

namespace kinemap::sim {

/// What the suit says of the wearer. Each segment's orientation is a little wrong; the positions follow from the
/// orientations along a body of wrong dimensions, so that its bones keep their lengths. Stance feet stay where they
/// were put (`hold_feet`), or slip along with the body, the legs being a little wrong as well. Call in frame order.
class Suit {
 public:
  Suit(const Wearer& wearer, const Score& score, const Gait& gait, const Performer& performer, const Building& building,
       const DriftColumn& column, bool hold_feet, Random& random);

  /// The reported pose of frame `i` (0, 1, 2, …), given the true one.
  Pose23 report(std::size_t i, const Pose23& truth);

  [[nodiscard]] const Body& body() const { return body_; }
  [[nodiscard]] const Slip& slip() const { return slip_; }
  [[nodiscard]] const std::vector<MagneticPatch>& patches() const { return patches_; }

 private:
  /// Orientation errors of one arm's joints and the unrest of its wrist.
  struct Arm {
    std::vector<Wander> joints;  ///< 3 joints × 3 axes
    std::vector<Wander> slow;    ///< wrist, 3 axes, m
    MagneticPull pull;
  };
  /// Unrest of a foot that is not held: x and y (m) and turn (rad).
  using Leg = std::array<Wander, 3>;
  Leg make_leg(Random& random) const;
  Arm make_arm(Random& random) const;
  void report_trunk(std::size_t i, const Pose23& truth, Pose23& out);
  void report_arm(Side side, std::size_t i, const Pose23& truth, Pose23& out);
  void report_leg(Side side, std::size_t i, const Pose23& truth, Pose23& out);
  [[nodiscard]] Vec3 reported_ball(Side side, std::size_t frame, const Vec3& ball) const;

  const Wearer& wearer_;
  const Score& score_;
  const Gait& gait_;
  DriftColumn column_;
  Random& random_;
  Body body_;
  std::vector<MagneticPatch> patches_;
  Slip slip_;
  std::vector<Vec2> true_pelvis_;
  std::array<Wander, 2> tilt_;
  Quat tilt_now_ = Quat::Identity();
  std::array<Arm, 2> arms_;
  std::optional<std::array<Leg, 2>> legs_;  ///< none: standing feet are held
};

}  // namespace kinemap::sim
