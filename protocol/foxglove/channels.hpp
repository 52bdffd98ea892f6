// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

/// Kinemap's map in the messages that Foxglove and Lichtblick show with no plug-in: the same channels live
/// (daemon/foxglove_session.cpp) and in session.mcap. protocol/README.md describes them.
namespace kinemap::foxglove {

enum class Channel : std::uint8_t { Transforms, Scene, Trajectory, Floor, Log };
inline constexpr std::size_t kChannelCount = 5;
inline constexpr std::array<Channel, kChannelCount> kChannels{Channel::Transforms, Channel::Scene, Channel::Trajectory,
                                                              Channel::Floor, Channel::Log};

/// One message, in JSON (encoding "json").
struct Message {
  Channel channel = Channel::Log;
  std::uint64_t time_ns = 0;  ///< stream time, since the first frame
  std::string json;
};

const char* topic(Channel channel);        ///< "/tf", "/map/scene", …
const char* schema_name(Channel channel);  ///< "foxglove.FrameTransforms", …
/// The JSON Schema of the channel's messages: Foxglove's, of the fields that we use. Its root is an object, without
/// $ref; enumerations are oneOf with const, bytes are base64: what the viewers' readers want.
std::string schema_text(Channel channel);

/// Stream time (s, not negative) in the protocol's nanoseconds.
std::uint64_t nanoseconds(double time_s);

}  // namespace kinemap::foxglove
