// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iterator>

#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/mxtp.hpp"
#include "protocol/wire/utf8.hpp"

namespace kinemap::mxtp {

namespace {

constexpr std::int32_t kMostSegments = 255;
constexpr std::int32_t kMostPoints = 4096;
constexpr std::int32_t kLongestName = 256;
constexpr float kLargestBody = 10.0F;  // m

/// Reads the parts of a type 13 message; the first fault sticks, as the cursor's error does.
class ScaleReader {
 public:
  explicit ScaleReader(BigEndianReader in) : in_(in) {}

  [[nodiscard]] const BigEndianReader& cursor() const { return in_; }
  [[nodiscard]] std::optional<Fault> fault() const { return fault_; }

  void segments(std::vector<ScaleSegment>& out) {
    const std::int32_t n = count(kMostSegments);
    for (std::int32_t i = 0; i < n && !fault_; ++i) {
      ScaleSegment s;
      s.name = name();
      s.origin = vector();
      out.push_back(std::move(s));
    }
  }
  void points(std::vector<ScalePoint>& out) {
    const std::int32_t n = count(kMostPoints);
    for (std::int32_t i = 0; i < n && !fault_; ++i) {
      ScalePoint p;
      p.segment = in_.u16();
      p.point = in_.u16();
      p.name = name();
      p.flags = in_.u32();
      p.position = vector();
      out.push_back(std::move(p));
    }
  }

 private:
  void fail(Fault f) {
    if (!fault_) fault_ = f;
  }
  std::int32_t count(std::int32_t most) {
    const std::int32_t n = in_.i32();
    if (!in_.ok()) fail(Fault::TooShort);
    if (n < 0 || n > most) fail(Fault::BadItemCount);
    return n;
  }
  std::string name() {
    const std::int32_t length = in_.i32();
    if (!in_.ok()) fail(Fault::TooShort);
    if (length < 0 || length > kLongestName) fail(Fault::BadText);
    if (fault_) return {};
    const std::string_view text = in_.text(static_cast<std::size_t>(length));
    if (!in_.ok()) fail(Fault::TooShort);
    if (!is_utf8(text)) fail(Fault::BadText);
    return std::string(text);
  }
  std::array<float, 3> vector() {
    std::array<float, 3> v{in_.f32(), in_.f32(), in_.f32()};
    if (!in_.ok()) fail(Fault::TooShort);
    for (const float f : v) {
      if (!std::isfinite(f)) fail(Fault::NotFinite);
      if (std::abs(f) > kLargestBody) fail(Fault::OutOfRange);
    }
    return v;
  }

  BigEndianReader in_;
  std::optional<Fault> fault_;
};

}  // namespace

// A real sender's first part ends with a point count of 0 and yet announces more parts, so a message is taken as a row
// of blocks {segments, points}; a later block may lack its segments. The two readings cannot be mistaken for each
// other: the first four bytes of a point, read as a name's length, are past any name.
std::variant<Scale, Fault> decode_scale(std::span<const std::byte> bytes) {
  Scale out;
  BigEndianReader at(bytes);
  do {
    Scale block;
    ScaleReader whole(at);
    whole.segments(block.segments);
    if (!whole.fault()) whole.points(block.points);
    ScaleReader points_only(at);
    if (whole.fault() && !out.segments.empty()) {
      block = {};
      points_only.points(block.points);
      if (points_only.fault()) return *whole.fault();
      at = points_only.cursor();
    } else if (whole.fault()) {
      return *whole.fault();
    } else {
      at = whole.cursor();
    }
    std::move(block.segments.begin(), block.segments.end(), std::back_inserter(out.segments));
    std::move(block.points.begin(), block.points.end(), std::back_inserter(out.points));
    if (out.segments.size() > kMostSegments || out.points.size() > kMostPoints) return Fault::BadItemCount;
  } while (at.remaining() > 0);
  return out;
}

}  // namespace kinemap::mxtp
