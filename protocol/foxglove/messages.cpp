// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/messages.hpp"

#include <array>
#include <cassert>

#include "core/body.hpp"
#include "protocol/foxglove/json.hpp"

namespace kinemap::foxglove {
namespace {

/// A segment's frame and the segment that it hangs on.
struct Joint {
  const char* frame;
  Segment parent;
};
// In the order of Segment, so that parents come first. The pelvis hangs on odom.
constexpr std::array<Joint, kSegmentCount> kJoints{{{"pelvis", Segment::Pelvis},
                                                    {"l5", Segment::Pelvis},
                                                    {"l3", Segment::L5},
                                                    {"t12", Segment::L3},
                                                    {"t8", Segment::T12},
                                                    {"neck", Segment::T8},
                                                    {"head", Segment::Neck},
                                                    {"right_shoulder", Segment::T8},
                                                    {"right_upper_arm", Segment::RightShoulder},
                                                    {"right_forearm", Segment::RightUpperArm},
                                                    {"right_hand", Segment::RightForearm},
                                                    {"left_shoulder", Segment::T8},
                                                    {"left_upper_arm", Segment::LeftShoulder},
                                                    {"left_forearm", Segment::LeftUpperArm},
                                                    {"left_hand", Segment::LeftForearm},
                                                    {"right_upper_leg", Segment::Pelvis},
                                                    {"right_lower_leg", Segment::RightUpperLeg},
                                                    {"right_foot", Segment::RightLowerLeg},
                                                    {"right_toe", Segment::RightFoot},
                                                    {"left_upper_leg", Segment::Pelvis},
                                                    {"left_lower_leg", Segment::LeftUpperLeg},
                                                    {"left_foot", Segment::LeftLowerLeg},
                                                    {"left_toe", Segment::LeftFoot}}};

}  // namespace

Message transforms(double time_s, const Pose& T_map_odom, std::span<const Pose> T_odom_segments) {
  assert(T_odom_segments.size() <= kSegmentCount);
  const Json stamp = time_json(time_s);
  Json list = Json::array();
  const auto add = [&](const char* parent, const char* child, const Pose& T_parent_child) {
    list.push_back({{"timestamp", stamp},
                    {"parent_frame_id", parent},
                    {"child_frame_id", child},
                    {"translation", vector_json(T_parent_child.p)},
                    {"rotation", quaternion_json(T_parent_child.q)}});
  };
  add(kMapFrame, kOdomFrame, T_map_odom);
  for (std::size_t i = 0; i < T_odom_segments.size(); ++i) {
    const auto parent = static_cast<std::size_t>(kJoints[i].parent);
    if (i == 0)
      add(kOdomFrame, kJoints[i].frame, T_odom_segments[i]);
    else
      add(kJoints[parent].frame, kJoints[i].frame, T_odom_segments[parent].inverse() * T_odom_segments[i]);
  }
  return {Channel::Transforms, nanoseconds(time_s), text_of({{"transforms", std::move(list)}})};
}

Message trajectory(const MapSnapshot& map, std::size_t max_poses) {
  const std::size_t n = map.trajectory.size();
  const std::size_t step = max_poses == 0 ? 1 : (n + max_poses - 1) / max_poses;
  Json poses = Json::array();
  for (std::size_t i = 0; i < n; ++i)
    if (i % step == 0 || i + 1 == n) poses.push_back(pose_json(map.trajectory[i].T_map_pelvis));
  return {Channel::Trajectory, nanoseconds(map.time_s),
          text_of({{"timestamp", time_json(map.time_s)}, {"frame_id", kMapFrame}, {"poses", std::move(poses)}})};
}

Message log(double time_s, LogLevel level, const std::string& text) {
  return {Channel::Log, nanoseconds(time_s),
          text_of({{"timestamp", time_json(time_s)},
                   {"level", static_cast<int>(level)},
                   {"message", text},
                   {"name", "kinemap"},
                   {"file", ""},
                   {"line", 0}})};
}

}  // namespace kinemap::foxglove
