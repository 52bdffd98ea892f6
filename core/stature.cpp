// SPDX-License-Identifier: Apache-2.0
#include "core/stature.hpp"

namespace kinemap {
namespace {

constexpr double kLimbShare = 0.245 + 0.246 + 0.186 + 0.146;

double bone(const SuitFrame& frame, Segment from, Segment to) { return (frame[to].p - frame[from].p).norm(); }

}  // namespace

std::optional<double> stature_from_bones(const SuitFrame& frame) {
  using enum Segment;
  const double right = bone(frame, RightUpperLeg, RightLowerLeg) + bone(frame, RightLowerLeg, RightFoot) +
                       bone(frame, RightUpperArm, RightForearm) + bone(frame, RightForearm, RightHand);
  const double left = bone(frame, LeftUpperLeg, LeftLowerLeg) + bone(frame, LeftLowerLeg, LeftFoot) +
                      bone(frame, LeftUpperArm, LeftForearm) + bone(frame, LeftForearm, LeftHand);
  const double stature = 0.5 * (right + left) / kLimbShare;
  if (!(stature > 1.2 && stature < 2.3)) return std::nullopt;
  return stature;
}

}  // namespace kinemap
