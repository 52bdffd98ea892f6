// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/seat_posture.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

struct Leg {
  Segment hip, knee, ankle;
};
constexpr std::array<Leg, 2> kLegs{{{Segment::LeftUpperLeg, Segment::LeftLowerLeg, Segment::LeftFoot},
                                    {Segment::RightUpperLeg, Segment::RightLowerLeg, Segment::RightFoot}}};

}  // namespace

SeatPosture seat_posture_of(const SuitFrame& frame, const std::array<Sole, 2>& soles, double shank_min) {
  const Pose& pelvis = frame[Segment::Pelvis];
  const double heading = heading_of(pelvis.q);
  const Eigen::Vector3d forward(std::cos(heading), std::sin(heading), 0);
  SeatPosture posture;
  posture.thigh_mean = 0.0;
  posture.thigh_max = -1.0;
  double leg_m = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d thigh = frame[kLegs[i].hip].p - frame[kLegs[i].knee].p;
    const Eigen::Vector3d shank = frame[kLegs[i].knee].p - frame[kLegs[i].ankle].p;
    const double thigh_up = thigh.z() / thigh.norm();
    posture.thigh_mean += 0.5 * thigh_up;
    posture.thigh_max = std::max(posture.thigh_max, thigh_up);
    leg_m += 0.5 * (thigh.norm() + shank.norm() + soles[i].height_of_ankle_m);
    // A shank stretched out to the front may be level as well: that is a sitter with long legs.
    posture.kneels = posture.kneels || (shank.z() < shank_min * shank.norm() && forward.dot(shank) > 0.0);
  }
  posture.hips_m = pelvis.p.z() - std::min(soles[0].lowest_m(), soles[1].lowest_m());
  posture.hips_share = posture.hips_m / leg_m;
  const Eigen::Vector3d trunk = frame[Segment::Neck].p - pelvis.p;
  posture.trunk_up = trunk.z() / trunk.norm();
  return posture;
}

bool legs_sit(const SeatPosture& posture, bool active, const TrackerConfig::Sitting& config) {
  const double thigh_on = posture.hips_m < config.low_hips_m ? config.thigh_low_on : config.thigh_on;
  const double limit = active ? config.thigh_off : thigh_on;
  return posture.thigh_mean < limit && posture.thigh_max < limit + config.thigh_spread && !posture.kneels &&
         posture.hips_share > config.hips_min_share && posture.hips_share < config.hips_max_share &&
         (active || posture.trunk_up > config.trunk_min);
}

}  // namespace kinemap
