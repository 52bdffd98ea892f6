// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/body.hpp"

#include "protocol/wire/segment_names.hpp"

namespace kinemap::sim {

namespace {

void set_sides(Body& body, Bone right, Bone left, const Vec3& right_offset) {
  body.offset[right] = right_offset;
  body.offset[left] = right_offset.cwiseProduct(Vec3(1, -1, 1));
}

/// The lengths that vary independently between people, left and right alike: index of the right (or only) bone and of
/// its twin.
constexpr std::array<std::array<Bone, 2>, 13> kGroups{{{kL5, kL5},
                                                       {kL3, kL3},
                                                       {kT12, kT12},
                                                       {kT8, kT8},
                                                       {kNeck, kNeck},
                                                       {kHead, kHead},
                                                       {kRightShoulder, kLeftShoulder},
                                                       {kRightUpperArm, kLeftUpperArm},
                                                       {kRightForearm, kLeftForearm},
                                                       {kRightHand, kLeftHand},
                                                       {kRightUpperLeg, kLeftUpperLeg},
                                                       {kRightLowerLeg, kLeftLowerLeg},
                                                       {kRightFoot, kLeftFoot}}};

void vary(Body& body, double common_sigma, double own_sigma, Random& random) {
  const double common = random.bounded_normal(common_sigma, 2.5);
  for (const auto& group : kGroups) {
    const double factor = 1.0 + common + random.bounded_normal(own_sigma, 2.5);
    body.offset[group[0]] *= factor;
    if (group[1] != group[0]) body.offset[group[1]] *= factor;
  }
}

}  // namespace

const char* bone_name(std::size_t bone) { return kSegmentNames[bone]; }

Body make_body(double stature_m, Random& random) {
  Body body;
  const double h = stature_m;
  body.stature = h;
  body.offset[kPelvis] = Vec3::Zero();
  body.offset[kL5] = Vec3(-0.004, 0, 0.052) * h;
  body.offset[kL3] = Vec3(0, 0, 0.060) * h;
  body.offset[kT12] = Vec3(0, 0, 0.055) * h;
  body.offset[kT8] = Vec3(0, 0, 0.055) * h;
  body.offset[kNeck] = Vec3(0, 0, 0.077) * h;
  body.offset[kHead] = Vec3(0, 0, 0.050) * h;
  set_sides(body, kRightShoulder, kLeftShoulder, Vec3(0, -0.017, 0.055) * h);
  set_sides(body, kRightUpperArm, kLeftUpperArm, Vec3(0, -0.086, 0) * h);
  set_sides(body, kRightForearm, kLeftForearm, Vec3(0, -0.178, 0) * h);
  set_sides(body, kRightHand, kLeftHand, Vec3(0, -0.146, 0) * h);
  set_sides(body, kRightUpperLeg, kLeftUpperLeg, Vec3(0, -0.050, 0) * h);
  set_sides(body, kRightLowerLeg, kLeftLowerLeg, Vec3(0, 0, -0.245) * h);
  set_sides(body, kRightFoot, kLeftFoot, Vec3(0, 0, -0.246) * h);
  vary(body, 0.0, 0.015, random);
  body.ankle_height = 0.043 * h;
  body.ball_height = 0.012 * h;
  set_sides(body, kRightToe, kLeftToe, Vec3(0.095 * h, 0, body.ball_height - body.ankle_height));
  return body;
}

Body mismeasured(const Body& body, double sigma, Random& random) {
  Body wrong = body;
  // Half of the variance is common: most dimensions are derived from the body height that was typed in.
  vary(wrong, sigma / std::sqrt(2.0), sigma / std::sqrt(2.0), random);
  return wrong;
}

void place_chain(const Body& body, Pose23& pose, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i <= last; ++i) {
    const auto& parent = pose[static_cast<std::size_t>(kParent[i])];
    pose[i].p = parent.p + parent.q * body.offset[i];
  }
}

void forward_kinematics(const Body& body, Pose23& pose) { place_chain(body, pose, 1, kBones - 1); }

}  // namespace kinemap::sim
