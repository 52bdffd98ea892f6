// SPDX-License-Identifier: Apache-2.0
#include "protocol/tum.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace kinemap {
namespace {

/// Locale-free parse of the 8 numbers of a line; false when there are fewer, more, or not numbers.
bool parse_numbers(const std::string& line, std::array<double, 8>& numbers) {
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  };
  for (double& number : numbers) {
    skip_blanks();
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc{} || !std::isfinite(number)) return false;
    at = next;
  }
  skip_blanks();
  return at == end;
}

template <class PoseOf>
std::string text_of(const MapSnapshot& map, PoseOf pose_of) {
  std::vector<TimedPose> poses;
  poses.reserve(map.trajectory.size());
  for (const TrajectoryPose& pose : map.trajectory) poses.push_back({pose.time_s, pose_of(pose)});
  return tum_text(poses);
}

}  // namespace

std::string tum_text(std::span<const TimedPose> poses) {
  std::string text = "# t x y z qx qy qz qw\n";
  std::array<char, 256> line{};
  for (const auto& [time_s, pose] : poses) {
    const int length =
        std::snprintf(line.data(), line.size(), "%.6f %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", time_s, pose.p.x(),
                      pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
    text.append(line.data(), std::min(static_cast<std::size_t>(length), line.size() - 1));
  }
  return text;
}

std::string optimised_tum(const MapSnapshot& map) {
  return text_of(map, [](const TrajectoryPose& pose) { return pose.T_map_pelvis; });
}

std::string odometry_tum(const MapSnapshot& map) {
  return text_of(map, [](const TrajectoryPose& pose) { return pose.T_odom_pelvis; });
}

Result<std::vector<TimedPose>> tum_from_text(const std::string& text) {
  std::vector<TimedPose> poses;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    std::array<double, 8> v{};
    const std::string where = "line " + std::to_string(number) + ": ";
    if (!parse_numbers(line, v)) return Error{where + "expected 8 numbers: t x y z qx qy qz qw"};
    TimedPose pose{v[0], {{v[1], v[2], v[3]}, {v[7], v[4], v[5], v[6]}}};
    if (std::abs(pose.pose.q.norm() - 1.0) > 1e-2) return Error{where + "the quaternion is not a unit quaternion"};
    pose.pose.q.normalize();
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace kinemap
