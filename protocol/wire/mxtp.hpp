// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// The MVN real-time network protocol: datagrams as values, and back. Bytes only: no odometry, no time-line, no core.
/// protocol/README.md is the specification.
namespace kinemap::mxtp {

inline constexpr std::uint16_t kDefaultPort = 9763;
inline constexpr std::size_t kHeaderSize = 24;
inline constexpr std::size_t kBodySegments = 23;

struct Header {
  int type = 2;  ///< the two digits after "MXTP"
  std::uint32_t sample_counter = 0;
  std::uint8_t datagram_index = 0;  ///< 0–127 within the sample
  bool last_datagram = true;
  std::uint8_t items = 0;
  std::uint32_t time_code_ms = 0;
  std::uint8_t character = 0;
  std::uint8_t body_segments = kBodySegments;
  std::uint8_t props = 0;
  std::uint8_t finger_segments = 0;
  std::uint16_t payload_size = 0;  ///< 0 from old senders
};

/// One item of type 02 (and of type 01 after conversion): metres, z up, right-handed, quaternion w x y z, unit.
struct SegmentItem {
  std::int32_t id = 0;  ///< 1-based MVN segment id
  std::array<float, 3> position{};
  std::array<float, 4> orientation{1, 0, 0, 0};
};

struct PoseItems {  ///< types 01 and 02
  std::vector<SegmentItem> items;
};
struct MetaData {  ///< type 12: "tag:value" lines
  std::vector<std::pair<std::string, std::string>> tags;
};
struct ScaleSegment {
  std::string name;
  std::array<float, 3> origin{};  ///< T-pose, m
};
struct ScalePoint {
  std::uint16_t segment = 0;
  std::uint16_t point = 0;
  std::string name;
  std::uint32_t flags = 0;
  std::array<float, 3> position{};  ///< relative to the segment's origin in the T-pose, m
};
struct ScaleFragment {  ///< type 13: one datagram's part; a whole message may span several
  std::vector<std::byte> bytes;
};
struct Scale {  ///< type 13, put together
  std::vector<ScaleSegment> segments;
  std::vector<ScalePoint> points;
};
struct CenterOfMass {  ///< type 24
  std::array<float, 3> position{};
};
/// One item of type 23: what a motion tracker measures. Vectors are in the tracker's own axes, but for the free
/// acceleration.
struct TrackerItem {
  std::int32_t id = 0;                           ///< of the segment that carries it, 1-based
  std::array<float, 4> orientation{1, 0, 0, 0};  ///< of the tracker in the world, w x y z, unit
  std::array<float, 3> free_acceleration{};      ///< without gravity, world axes, m/s²
  std::array<float, 3> acceleration{};           ///< with gravity, m/s²
  std::array<float, 3> angular_velocity{};       ///< rad/s
  std::array<float, 3> magnetic_field{};         ///< 1: as strong as where the suit's sensors were calibrated
};
struct TrackerItems {  ///< type 23
  std::vector<TrackerItem> items;
};
struct TimeCode {  ///< type 25, "HH:MM:SS.mmm"
  std::string text;
};
struct Skipped {};  ///< a known type whose payload we do not use

using Payload = std::variant<PoseItems, MetaData, ScaleFragment, CenterOfMass, TrackerItems, TimeCode, Skipped>;

struct Datagram {
  Header header;
  Payload payload;
};

/// Why a datagram was refused; each has its own counter.
enum class Fault : std::uint8_t {
  TooShort,      ///< less than a header, or less than the items announced
  BadMagic,      ///< not "MXTP" + two digits
  UnknownType,   ///< digits that the protocol does not define
  BadLength,     ///< payload size and length disagree, or trailing bytes
  BadItemCount,  ///< item count and header counts disagree
  NotFinite,     ///< NaN or infinity
  NotUnit,       ///< a quaternion's norm is off 1 by more than 1 %
  OutOfRange,    ///< a position beyond 100 km, an id beyond any segment
  BadText,       ///< a string field's length or UTF-8 is wrong
};
inline constexpr std::size_t kFaultCount = 9;
const char* to_string(Fault fault);

/// Decodes one datagram. Every length is checked; never reads past the span, never throws.
std::variant<Datagram, Fault> decode(std::span<const std::byte> bytes);

/// Decodes a whole type 13 message, put together from its fragments in order.
std::variant<Scale, Fault> decode_scale(std::span<const std::byte> bytes);

// Encoders: one sample into one or several datagrams no longer than `max_datagram` bytes; `header.items`,
// `datagram_index`, `last_datagram` and `payload_size` are filled in.
using Bytes = std::vector<std::byte>;
std::vector<Bytes> encode_poses(Header header, std::span<const SegmentItem> items,
                                std::size_t max_datagram = 2040);  ///< 02
std::vector<Bytes> encode_poses_euler(Header header, std::span<const SegmentItem> items,
                                      std::size_t max_datagram = 2040);  ///< 01: cm, degrees, y up
Bytes encode_meta(Header header, const MetaData& meta);
std::vector<Bytes> encode_scale(Header header, const Scale& scale, std::size_t max_datagram = 2040);
Bytes encode_center_of_mass(Header header, const CenterOfMass& com);
std::vector<Bytes> encode_trackers(Header header, std::span<const TrackerItem> items,
                                   std::size_t max_datagram = 2040);  ///< 23
Bytes encode_time_code(Header header, const TimeCode& time_code);

}  // namespace kinemap::mxtp
