// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/feet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinemap {
namespace {

using Eigen::Vector3d;

// The stream has no outline of the foot: typical sizes, m.
constexpr double kHeelBehindAnkle = 0.05;
constexpr double kTipBeforeBall = 0.06;
constexpr double kHalfWidth = 0.045;
constexpr double kOnFloor = 0.08;  // a foot whose sole is higher than this over the other one carries nothing

// Mass fraction of each body part and where its centre lies between two points of the stream.
struct Part {
  Segment from;
  Segment to;
  double centre;  // 0 at `from`, 1 at `to`
  double mass;
};
constexpr std::array<Part, 14> kParts{{
    {Segment::Pelvis, Segment::L5, 0.5, 0.1117},
    {Segment::L3, Segment::T12, 0.5, 0.1633},
    {Segment::T8, Segment::Neck, 0.5, 0.1596},
    {Segment::Neck, Segment::Head, 1.8, 0.0694},  // the head's centre lies above its joint
    {Segment::LeftUpperArm, Segment::LeftForearm, 0.577, 0.0271},
    {Segment::LeftForearm, Segment::LeftHand, 0.457, 0.0162 + 0.0061},
    {Segment::RightUpperArm, Segment::RightForearm, 0.577, 0.0271},
    {Segment::RightForearm, Segment::RightHand, 0.457, 0.0162 + 0.0061},
    {Segment::LeftUpperLeg, Segment::LeftLowerLeg, 0.41, 0.1416},
    {Segment::LeftLowerLeg, Segment::LeftFoot, 0.446, 0.0433},
    {Segment::LeftFoot, Segment::LeftToe, 0.5, 0.0137},
    {Segment::RightUpperLeg, Segment::RightLowerLeg, 0.41, 0.1416},
    {Segment::RightLowerLeg, Segment::RightFoot, 0.446, 0.0433},
    {Segment::RightFoot, Segment::RightToe, 0.5, 0.0137},
}};
// MVN's spine runs behind the middle of the trunk.
constexpr double kTrunkBeforeSpine = 0.02;
constexpr double kTrunkMass = 0.1117 + 0.1633 + 0.1596;

}  // namespace

std::array<Sole, 2> soles_of(const SuitFrame& frame, double ball_height_m) {
  std::array<Sole, 2> soles;
  for (std::size_t i = 0; i < 2; ++i) {
    const Pose& foot = frame[kFoot[i]];
    const Pose& toe = frame[kToe[i]];
    const double ankle_over_ball = -(foot.inverse() * toe.p).z();
    const double height = std::clamp(ankle_over_ball + ball_height_m, 0.03, 0.15);
    soles[i] = {foot * Vector3d(0, 0, -height), toe * Vector3d(0, 0, -ball_height_m), height};
  }
  return soles;
}

Vector3d center_of_mass_of(const SuitFrame& frame) {
  if (frame.center_of_mass) return *frame.center_of_mass;
  Vector3d sum = Vector3d::Zero();
  double mass = 0.0;
  for (const Part& part : kParts) {
    const Vector3d& from = frame[part.from].p;
    sum += part.mass * (from + part.centre * (frame[part.to].p - from));
    mass += part.mass;
  }
  const Vector3d forward = frame[Segment::L3].q * Vector3d::UnitX();
  return (sum + kTrunkMass * kTrunkBeforeSpine * forward) / mass;
}

double outside_of_feet_m(const SuitFrame& frame, const std::array<Sole, 2>& soles, const Vector3d& point) {
  const double floor_z = std::min(soles[0].lowest_m(), soles[1].lowest_m());
  std::array<Eigen::Vector2d, 8> corners;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (soles[i].lowest_m() > floor_z + kOnFloor) continue;
    const Pose& foot = frame[kFoot[i]];
    const Pose& toe = frame[kToe[i]];
    for (const double side : {-kHalfWidth, kHalfWidth}) {
      corners[count++] = (foot * Vector3d(-kHeelBehindAnkle, side, -soles[i].height_of_ankle_m)).head<2>();
      corners[count++] = (toe * Vector3d(kTipBeforeBall, side, 0)).head<2>();
    }
  }
  // The distance from a convex shape is the largest gap over all directions; 32 of them err by cos(5.6°) at most.
  constexpr int kDirections = 32;
  double outside = 0.0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kDirections;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    double reach = direction.dot(corners[0]);
    for (std::size_t i = 1; i < count; ++i) reach = std::max(reach, direction.dot(corners[i]));
    outside = std::max(outside, direction.dot(point.head<2>()) - reach);
  }
  return outside;
}

}  // namespace kinemap
