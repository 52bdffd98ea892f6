// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "protocol/wire/big_endian.hpp"

/// Packets and captures of every kind that the reader knows, made byte by byte for tests.
namespace kinemap::testing_support {

using Packet = std::vector<std::byte>;

inline Packet operator+(const Packet& a, const Packet& b) {
  Packet out = a;
  out.insert(out.end(), b.begin(), b.end());
  return out;
}

inline Packet packet_of(const std::string& text) {
  BigEndianWriter w;
  w.text(text);
  return w.release();
}

inline Packet udp(const Packet& payload, std::uint16_t from = 5000, std::uint16_t to = 9763) {
  BigEndianWriter w;
  w.u16(from);
  w.u16(to);
  w.u16(static_cast<std::uint16_t>(8 + payload.size()));
  w.u16(0);
  w.bytes(payload);
  return w.release();
}

/// An IPv4 packet 192.0.2.1 → 192.0.2.2; `flags_offset` is the 16-bit field of flags and offset / 8.
inline Packet ipv4(const Packet& body, std::uint16_t flags_offset = 0, std::uint16_t id = 7, std::uint8_t protocol = 17,
                   std::size_t option_bytes = 0) {
  BigEndianWriter w;
  w.u8(static_cast<std::uint8_t>(0x45U + option_bytes / 4));
  w.u8(0);
  w.u16(static_cast<std::uint16_t>(20 + option_bytes + body.size()));
  w.u16(id);
  w.u16(flags_offset);
  w.u8(64);
  w.u8(protocol);
  w.u16(0);
  w.u32(0xc0000201);
  w.u32(0xc0000202);
  for (std::size_t i = 0; i < option_bytes; ++i) w.u8(1);
  w.bytes(body);
  return w.release();
}

inline Packet ipv6(const Packet& body, std::uint8_t next = 17) {
  BigEndianWriter w;
  w.u32(0x60000000);
  w.u16(static_cast<std::uint16_t>(body.size()));
  w.u8(next);
  w.u8(64);
  for (const std::uint32_t word : {0x20010db8U, 0U, 0U, 1U, 0x20010db8U, 0U, 0U, 2U}) w.u32(word);
  w.bytes(body);
  return w.release();
}

/// An IPv6 extension header of `8 * (extra + 1)` bytes.
inline Packet extension(std::uint8_t next, const Packet& body, std::uint8_t extra = 0) {
  BigEndianWriter w;
  w.u8(next);
  w.u8(extra);
  for (int i = 0; i < 6 + 8 * extra; ++i) w.u8(0);
  w.bytes(body);
  return w.release();
}

inline Packet fragment6(std::uint8_t next, std::uint16_t offset, bool more, std::uint32_t id, const Packet& body) {
  BigEndianWriter w;
  w.u8(next);
  w.u8(0);
  w.u16(static_cast<std::uint16_t>(offset | (more ? 1U : 0U)));
  w.u32(id);
  w.bytes(body);
  return w.release();
}

inline Packet ethernet(const Packet& ip, std::uint16_t type = 0x0800, int vlan_tags = 0) {
  BigEndianWriter w;
  for (int i = 0; i < 12; ++i) w.u8(2);
  for (int i = 0; i < vlan_tags; ++i) {
    w.u16(i == 0 && vlan_tags > 1 ? 0x88a8 : 0x8100);
    w.u16(5);
  }
  w.u16(type);
  w.bytes(ip);
  return w.release();
}

struct CaptureFormat {
  bool little_endian = true;
  bool nanoseconds = false;
  std::uint32_t link_type = 1;
};

/// A capture file; records are 1 ms apart, the first at 1000.25 s.
inline std::vector<std::byte> capture(const CaptureFormat& format, const std::vector<Packet>& packets) {
  BigEndianWriter w;
  const auto u32 = [&](std::uint32_t v) {
    w.u32(format.little_endian ? (v >> 24U | (v >> 8U & 0xff00U) | (v << 8U & 0xff0000U) | v << 24U) : v);
  };
  u32(format.nanoseconds ? 0xa1b23c4d : 0xa1b2c3d4);
  format.little_endian ? w.u32(0x02000400) : w.u32(0x00020004);
  u32(0);
  u32(0);
  u32(65535);
  u32(format.link_type);
  std::uint32_t n = 0;
  for (const Packet& p : packets) {
    u32(1000);
    const std::uint32_t us = 250'000 + 1000 * n++;
    u32(format.nanoseconds ? 1000 * us : us);
    u32(static_cast<std::uint32_t>(p.size()));
    u32(static_cast<std::uint32_t>(p.size()));
    w.bytes(p);
  }
  return w.release();
}

/// A file in the test's own directory, removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name) : path_(std::string(KINEMAP_BINARY_DIR) + "/" + name) {}
  ~TemporaryFile() { std::remove(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  void write(const void* data, std::size_t size) const {
    std::ofstream(path_, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  void write(const std::vector<std::byte>& bytes) const { write(bytes.data(), bytes.size()); }
  void write(const std::string& text) const { write(text.data(), text.size()); }

 private:
  std::string path_;
};

}  // namespace kinemap::testing_support
