// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace kinemap {

/// Reads big-endian numbers off a span. Its error sticks: after the first read past the end all reads give zero or
/// nothing and `ok()` stays false, so that a decoder checks once, at the end of a field group, and can never leave the
/// span.
class BigEndianReader {
 public:
  explicit BigEndianReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t position() const { return at_; }

  /// The next `n` bytes; empty (and not ok) when there are fewer.
  std::span<const std::byte> take(std::size_t n) {
    if (!ok_ || n > remaining()) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    const auto part = bytes_.subspan(at_, n);
    at_ += n;
    return part;
  }
  std::string_view text(std::size_t n) {
    const auto part = take(n);
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(unsigned_number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(unsigned_number(2)); }
  std::uint32_t u32() { return unsigned_number(4); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }

 private:
  std::uint32_t unsigned_number(std::size_t n) {
    std::uint32_t value = 0;
    for (const std::byte b : take(n)) value = (value << 8U) | std::to_integer<std::uint32_t>(b);
    return value;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// Appends big-endian numbers to a byte vector.
class BigEndianWriter {
 public:
  void u8(std::uint8_t v) { bytes_.push_back(std::byte{v}); }
  void u16(std::uint16_t v) {
    u8(static_cast<std::uint8_t>(v >> 8U));
    u8(static_cast<std::uint8_t>(v & 0xffU));
  }
  void u32(std::uint32_t v) {
    u16(static_cast<std::uint16_t>(v >> 16U));
    u16(static_cast<std::uint16_t>(v & 0xffffU));
  }
  void i32(std::int32_t v) { u32(static_cast<std::uint32_t>(v)); }
  void f32(float v) { u32(std::bit_cast<std::uint32_t>(v)); }
  void text(std::string_view v) {
    for (const char c : v) u8(static_cast<std::uint8_t>(c));
  }
  void bytes(std::span<const std::byte> v) { bytes_.insert(bytes_.end(), v.begin(), v.end()); }

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] const std::vector<std::byte>& view() const { return bytes_; }
  std::vector<std::byte> release() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace kinemap
