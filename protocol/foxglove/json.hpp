// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "core/pose.hpp"

/// The values that Foxglove's messages are made of, as JSON.
namespace kinemap::foxglove {

using Json = nlohmann::ordered_json;
using Colour = std::array<double, 4>;  ///< red, green, blue, opacity, each 0–1

inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kOdomFrame = "odom";

Json time_json(double time_s);
/// Rounded to 0.1 mm: below any sigma, and short to send.
Json vector_json(const Eigen::Vector3d& v);
Json quaternion_json(const Eigen::Quaterniond& q);
Json pose_json(const Pose& pose);
Json colour_json(const Colour& colour);
/// Bytes that are no UTF-8 (names from outside) are replaced.
std::string text_of(const Json& json);

}  // namespace kinemap::foxglove
