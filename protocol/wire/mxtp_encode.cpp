// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "protocol/wire/axes.hpp"
#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/mxtp.hpp"

namespace kinemap::mxtp {

namespace {

Bytes datagram(const Header& h, std::span<const std::byte> payload) {
  BigEndianWriter w;
  w.text("MXTP");
  w.u8(static_cast<std::uint8_t>('0' + h.type / 10 % 10));
  w.u8(static_cast<std::uint8_t>('0' + h.type % 10));
  w.u32(h.sample_counter);
  w.u8(static_cast<std::uint8_t>((h.datagram_index & 0x7fU) | (h.last_datagram ? 0x80U : 0U)));
  w.u8(h.items);
  w.u32(h.time_code_ms);
  w.u8(h.character);
  w.u8(h.body_segments);
  w.u8(h.props);
  w.u8(h.finger_segments);
  w.u16(0);
  w.u16(static_cast<std::uint16_t>(payload.size()));
  w.bytes(payload);
  return w.release();
}

Bytes single(Header header, int type, std::uint8_t items, std::span<const std::byte> payload) {
  header.type = type;
  header.datagram_index = 0;
  header.last_datagram = true;
  header.items = items;
  return datagram(header, payload);
}

/// Cuts a payload into datagrams of whole `unit`s of bytes; `items` counts the units where `counted`.
std::vector<Bytes> split(Header header, std::span<const std::byte> payload, std::size_t unit, bool counted,
                         std::size_t max_datagram) {
  const std::size_t room = max_datagram > kHeaderSize ? max_datagram - kHeaderSize : 0;
  const std::size_t most = counted ? 255 : 65535 / unit;
  const std::size_t chunk = std::clamp<std::size_t>(room / unit, 1, most) * unit;
  std::vector<Bytes> out;
  std::size_t at = 0;
  do {
    const std::size_t n = std::min(chunk, payload.size() - at);
    header.datagram_index = static_cast<std::uint8_t>(out.size() & 0x7fU);
    header.last_datagram = at + n == payload.size();
    header.items = counted ? static_cast<std::uint8_t>(n / unit) : std::uint8_t{0};
    out.push_back(datagram(header, payload.subspan(at, n)));
    at += n;
  } while (at < payload.size());
  return out;
}

void put_vector(BigEndianWriter& w, const std::array<float, 3>& v) {
  for (const float f : v) w.f32(f);
}

void put_string(BigEndianWriter& w, const std::string& s) {
  w.i32(static_cast<std::int32_t>(s.size()));
  w.text(s);
}

}  // namespace

std::vector<Bytes> encode_poses(Header header, std::span<const SegmentItem> items, std::size_t max_datagram) {
  BigEndianWriter w;
  for (const SegmentItem& item : items) {
    w.i32(item.id);
    put_vector(w, item.position);
    for (const float f : item.orientation) w.f32(f);
  }
  header.type = 2;
  return split(header, w.view(), 32, true, max_datagram);
}

std::vector<Bytes> encode_poses_euler(Header header, std::span<const SegmentItem> items, std::size_t max_datagram) {
  BigEndianWriter w;
  for (const SegmentItem& item : items) {
    const EulerItem euler = to_euler(item);
    w.i32(item.id);
    put_vector(w, euler.position_cm);
    put_vector(w, euler.angles_deg);
  }
  header.type = 1;
  return split(header, w.view(), 28, true, max_datagram);
}

Bytes encode_meta(Header header, const MetaData& meta) {
  std::string text;
  for (const auto& [tag, value] : meta.tags) text += tag + ':' + value + '\n';
  BigEndianWriter w;
  put_string(w, text);
  return single(header, 12, 1, w.view());
}

std::vector<Bytes> encode_scale(Header header, const Scale& scale, std::size_t max_datagram) {
  BigEndianWriter w;
  w.i32(static_cast<std::int32_t>(scale.segments.size()));
  for (const ScaleSegment& s : scale.segments) {
    put_string(w, s.name);
    put_vector(w, s.origin);
  }
  w.i32(static_cast<std::int32_t>(scale.points.size()));
  for (const ScalePoint& p : scale.points) {
    w.u16(p.segment);
    w.u16(p.point);
    put_string(w, p.name);
    w.u32(p.flags);
    put_vector(w, p.position);
  }
  header.type = 13;
  return split(header, w.view(), 1, false, max_datagram);
}

Bytes encode_center_of_mass(Header header, const CenterOfMass& com) {
  BigEndianWriter w;
  put_vector(w, com.position);
  return single(header, 24, 1, w.view());
}

std::vector<Bytes> encode_trackers(Header header, std::span<const TrackerItem> items, std::size_t max_datagram) {
  BigEndianWriter w;
  for (const TrackerItem& item : items) {
    w.i32(item.id);
    for (const float f : item.orientation) w.f32(f);
    put_vector(w, item.free_acceleration);
    put_vector(w, item.acceleration);
    put_vector(w, item.angular_velocity);
    put_vector(w, item.magnetic_field);
  }
  header.type = 23;
  return split(header, w.view(), 68, true, max_datagram);
}

Bytes encode_time_code(Header header, const TimeCode& time_code) {
  BigEndianWriter w;
  put_string(w, time_code.text);
  return single(header, 25, 1, w.view());
}

}  // namespace kinemap::mxtp
