// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "protocol/wire/axes.hpp"
#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/mxtp.hpp"
#include "protocol/wire/utf8.hpp"

namespace kinemap::mxtp {

namespace {

constexpr std::array kKnownTypes{1, 2, 3, 4, 5, 10, 11, 12, 13, 20, 21, 22, 23, 24, 25};
constexpr float kFarthest = 1e5F;  // m; no building is larger
constexpr std::int32_t kLargestId = 255;
constexpr float kLargestAngle = 720.0F;  // degrees; a sender may not wrap, but does not count turns either
constexpr double kUnitTolerance = 0.01;

using PayloadOr = std::variant<Payload, Fault>;

bool is_finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool is_within(std::span<const float> values, float limit) {
  return std::all_of(values.begin(), values.end(), [=](float v) { return std::abs(v) <= limit; });
}

template <std::size_t N>
std::array<float, N> floats(BigEndianReader& in) {
  std::array<float, N> out{};
  for (float& v : out) v = in.f32();
  return out;
}

std::optional<Fault> fault_of(const SegmentItem& item) {
  if (!is_finite(item.position) || !is_finite(item.orientation)) return Fault::NotFinite;
  if (item.id < 0 || item.id > kLargestId || !is_within(item.position, kFarthest)) return Fault::OutOfRange;
  double norm2 = 0.0;
  for (const float v : item.orientation) norm2 += static_cast<double>(v) * v;
  if (std::abs(std::sqrt(norm2) - 1.0) > kUnitTolerance) return Fault::NotUnit;
  return std::nullopt;
}

std::variant<SegmentItem, Fault> read_quaternion_item(BigEndianReader& in) {
  SegmentItem item;
  item.id = in.i32();
  item.position = floats<3>(in);
  item.orientation = floats<4>(in);
  if (const auto fault = fault_of(item)) return *fault;
  return item;
}

std::variant<SegmentItem, Fault> read_euler_item(BigEndianReader& in) {
  const std::int32_t id = in.i32();
  EulerItem euler;
  euler.position_cm = floats<3>(in);
  euler.angles_deg = floats<3>(in);
  if (!is_finite(euler.position_cm) || !is_finite(euler.angles_deg)) return Fault::NotFinite;
  if (!is_within(euler.angles_deg, kLargestAngle)) return Fault::OutOfRange;
  const SegmentItem item = from_euler(id, euler);
  if (const auto fault = fault_of(item)) return *fault;
  return item;
}

PayloadOr read_poses(const Header& h, BigEndianReader& in) {
  const std::size_t item_size = h.type == 1 ? 28 : 32;
  if (in.remaining() < h.items * item_size) return Fault::TooShort;
  if (in.remaining() > h.items * item_size) return Fault::BadLength;
  // All three counts are 0 from senders before 2019, where these bytes were reserved.
  const int announced = h.body_segments + h.props + h.finger_segments;
  if (h.items == 0 || (announced > 0 && h.items > announced)) return Fault::BadItemCount;
  PoseItems out;
  out.items.reserve(h.items);
  for (int i = 0; i < h.items; ++i) {
    const auto item = h.type == 1 ? read_euler_item(in) : read_quaternion_item(in);
    if (const auto* fault = std::get_if<Fault>(&item)) return *fault;
    out.items.push_back(std::get<SegmentItem>(item));
  }
  return Payload{std::move(out)};
}

PayloadOr read_meta(BigEndianReader& in) {
  if (in.remaining() < 4) return Fault::TooShort;
  const std::int32_t length = in.i32();
  if (length < 0 || static_cast<std::size_t>(length) > in.remaining()) return Fault::BadText;
  std::string_view text = in.text(static_cast<std::size_t>(length));
  if (in.remaining() > 0) return Fault::BadLength;
  if (!is_utf8(text)) return Fault::BadText;
  MetaData out;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos) out.tags.emplace_back(line.substr(0, colon), line.substr(colon + 1));
  }
  return Payload{std::move(out)};
}

PayloadOr read_center_of_mass(BigEndianReader& in) {
  if (in.remaining() < 12) return Fault::TooShort;  // newer senders append velocity and acceleration
  const CenterOfMass com{floats<3>(in)};
  if (!is_finite(com.position)) return Fault::NotFinite;
  if (!is_within(com.position, kFarthest)) return Fault::OutOfRange;
  return Payload{com};
}

PayloadOr read_trackers(const Header& h, BigEndianReader& in) {
  constexpr std::size_t kItemSize = 68, kPublishedSize = 44;
  if (h.items == 0) return Fault::BadItemCount;
  if (in.remaining() == h.items * kPublishedSize) return Payload{Skipped{}};
  if (in.remaining() < h.items * kItemSize) return Fault::TooShort;
  if (in.remaining() > h.items * kItemSize) return Fault::BadLength;
  TrackerItems out;
  for (int i = 0; i < h.items; ++i) {
    TrackerItem item;
    item.id = in.i32();
    item.orientation = floats<4>(in);
    for (auto* v : {&item.free_acceleration, &item.acceleration, &item.angular_velocity, &item.magnetic_field}) {
      *v = floats<3>(in);
      if (!is_finite(*v)) return Fault::NotFinite;
    }
    if (const auto fault = fault_of(SegmentItem{item.id, item.magnetic_field, item.orientation})) return *fault;
    out.items.push_back(item);
  }
  return Payload{std::move(out)};
}

PayloadOr read_time_code(BigEndianReader& in) {
  constexpr std::string_view kPattern = "00:00:00.000";
  if (in.remaining() < kPattern.size()) return Fault::TooShort;
  if (in.remaining() != kPattern.size()) {
    if (in.remaining() != kPattern.size() + 4) return Fault::BadLength;
    if (in.i32() != static_cast<std::int32_t>(kPattern.size())) return Fault::BadText;
  }
  const std::string_view text = in.text(kPattern.size());
  for (std::size_t i = 0; i < kPattern.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kPattern[i] == '0' ? !digit : text[i] != kPattern[i]) return Fault::BadText;
  }
  return Payload{TimeCode{std::string(text)}};
}

PayloadOr read_payload(const Header& h, BigEndianReader& in) {
  switch (h.type) {
    case 1:
    case 2:
      return read_poses(h, in);
    case 12:
      return read_meta(in);
    case 13: {
      if (in.remaining() == 0) return Fault::TooShort;
      const auto bytes = in.take(in.remaining());
      return Payload{ScaleFragment{{bytes.begin(), bytes.end()}}};
    }
    case 23:
      return read_trackers(h, in);
    case 24:
      return read_center_of_mass(in);
    case 25:
      return read_time_code(in);
    default:
      return Payload{Skipped{}};
  }
}

Header read_header(BigEndianReader& in) {
  Header h;
  h.sample_counter = in.u32();
  const std::uint8_t datagram_counter = in.u8();
  h.datagram_index = datagram_counter & 0x7fU;
  h.last_datagram = (datagram_counter & 0x80U) != 0;
  h.items = in.u8();
  h.time_code_ms = in.u32();
  h.character = in.u8();
  h.body_segments = in.u8();
  h.props = in.u8();
  h.finger_segments = in.u8();
  in.u16();  // reserved
  h.payload_size = in.u16();
  return h;
}

}  // namespace

std::variant<Datagram, Fault> decode(std::span<const std::byte> bytes) {
  BigEndianReader in(bytes);
  const std::string_view magic = in.text(6);
  if (!in.ok()) return Fault::TooShort;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (!magic.starts_with("MXTP") || !is_digit(magic[4]) || !is_digit(magic[5])) return Fault::BadMagic;
  const int type = (magic[4] - '0') * 10 + (magic[5] - '0');
  if (std::find(kKnownTypes.begin(), kKnownTypes.end(), type) == kKnownTypes.end()) return Fault::UnknownType;
  Datagram out;
  out.header = read_header(in);
  out.header.type = type;
  if (!in.ok()) return Fault::TooShort;
  if (out.header.payload_size != 0 && out.header.payload_size != in.remaining()) return Fault::BadLength;
  auto payload = read_payload(out.header, in);
  if (const auto* fault = std::get_if<Fault>(&payload)) return *fault;
  out.payload = std::get<Payload>(std::move(payload));
  return out;
}

}  // namespace kinemap::mxtp
