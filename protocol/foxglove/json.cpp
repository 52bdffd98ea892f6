// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/json.hpp"

#include <cmath>

#include "protocol/foxglove/channels.hpp"

namespace kinemap::foxglove {
namespace {

double rounded(double value, double steps) { return std::round(value * steps) / steps + 0.0; }  // no −0

}  // namespace

Json time_json(double time_s) {
  const std::uint64_t ns = nanoseconds(time_s);
  return {{"sec", ns / 1000000000}, {"nsec", ns % 1000000000}};
}

Json vector_json(const Eigen::Vector3d& v) {
  return {{"x", rounded(v.x(), 1e4)}, {"y", rounded(v.y(), 1e4)}, {"z", rounded(v.z(), 1e4)}};
}

Json quaternion_json(const Eigen::Quaterniond& q) {
  return {
      {"x", rounded(q.x(), 1e5)}, {"y", rounded(q.y(), 1e5)}, {"z", rounded(q.z(), 1e5)}, {"w", rounded(q.w(), 1e5)}};
}

Json pose_json(const Pose& pose) {
  return {{"position", vector_json(pose.p)}, {"orientation", quaternion_json(pose.q)}};
}

Json colour_json(const Colour& c) { return {{"r", c[0]}, {"g", c[1]}, {"b", c[2]}, {"a", c[3]}}; }

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace kinemap::foxglove
