// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "protocol/tum.hpp"

namespace kinemap::eval {

/// The heading and translation `T_truth_map` that bring `p_map` nearest to `p_truth` in the least-squares sense (both n
/// points, n ≥ 2 that do not coincide; else nullopt). Height and tilt need no rotation: gravity is observed in both
/// frames.
std::optional<Pose> align(std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth);

/// Root mean square of |T_truth_map · p_map − p_truth|, m.
double rmse(const Pose& T_truth_map, std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth);

/// True over estimated extent of the trajectory in the plane of the floor: the root of the ratio of the summed squared
/// distances from the mean; nullopt when all points coincide. No loop closure sees it: a closed loop scales to a closed
/// loop.
std::optional<double> scale_between(std::span<const Eigen::Vector3d> p_map, std::span<const Eigen::Vector3d> p_truth);

/// The heading and translation `T_truth_map` that bring one pose onto its true one.
Pose align_at(const Pose& T_map_pelvis, const Pose& T_truth_pelvis);

/// Pose at `time_s`, between samples in proportion; nullopt outside them. `trajectory` by ascending time.
std::optional<Pose> pose_at(std::span<const TimedPose> trajectory, double time_s);

}  // namespace kinemap::eval
