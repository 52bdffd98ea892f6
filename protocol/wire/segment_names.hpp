// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kinemap {

/// The body segments as MVN writes them (type 13, MVNX), in stream order: index = segment id − 1.
// clang-format off
inline constexpr std::array<const char*, 23> kSegmentNames{
    "Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head",
    "RightShoulder", "RightUpperArm", "RightForeArm", "RightHand",
    "LeftShoulder", "LeftUpperArm", "LeftForeArm", "LeftHand",
    "RightUpperLeg", "RightLowerLeg", "RightFoot", "RightToe",
    "LeftUpperLeg", "LeftLowerLeg", "LeftFoot", "LeftToe"};
// clang-format on

}  // namespace kinemap
