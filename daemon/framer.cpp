// SPDX-License-Identifier: Apache-2.0
#include "daemon/framer.hpp"

#include <algorithm>
#include <array>

#include "protocol/wire/mxtp.hpp"

namespace kinemap {
namespace {

constexpr std::array<std::byte, 4> kMagic{std::byte{'M'}, std::byte{'X'}, std::byte{'T'}, std::byte{'P'}};
constexpr std::size_t kGarbageLimit = 65536;
constexpr std::size_t kLongest = mxtp::kHeaderSize + 65535;
constexpr std::size_t kItemsOffset = 11;
constexpr std::size_t kPayloadSizeOffset = 22;
constexpr std::size_t kWait = 0;  // more bytes are needed to know

}  // namespace

std::size_t StreamFramer::find_magic(std::size_t from) const {
  const auto begin = buffer_.begin() + static_cast<std::ptrdiff_t>(std::min(from, buffer_.size()));
  return static_cast<std::size_t>(std::search(begin, buffer_.end(), kMagic.begin(), kMagic.end()) - buffer_.begin());
}

/// Length of the datagram whose header stands at `at`, or kWait.
std::size_t StreamFramer::length_at(std::size_t at) const {
  const auto byte = [&](std::size_t offset) { return std::to_integer<std::size_t>(buffer_[at + offset]); };
  const std::size_t payload = byte(kPayloadSizeOffset) << 8 | byte(kPayloadSizeOffset + 1);
  if (payload != 0) return mxtp::kHeaderSize + payload;
  if (byte(4) == '0' && byte(5) == '1') return mxtp::kHeaderSize + byte(kItemsOffset) * 28;
  if (byte(4) == '0' && byte(5) == '2') return mxtp::kHeaderSize + byte(kItemsOffset) * 32;
  const std::size_t next = find_magic(at + mxtp::kHeaderSize);
  if (next < buffer_.size()) return next - at;
  return buffer_.size() - at > kLongest ? mxtp::kHeaderSize : kWait;
}

bool StreamFramer::add(std::span<const std::byte> bytes, const Sink& sink) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  while (buffer_.size() - at >= mxtp::kHeaderSize) {
    const std::size_t header = find_magic(at);
    if (header != at) {
      // Without a header in sight, the last bytes may be the beginning of one.
      const std::size_t keep_from = header < buffer_.size() ? header : buffer_.size() - (kMagic.size() - 1);
      skipped_ += keep_from - at;
      garbage_run_ += keep_from - at;
      at = keep_from;
      if (garbage_run_ > kGarbageLimit) return false;
      continue;
    }
    const std::size_t length = length_at(at);
    if (length == kWait || buffer_.size() - at < length) break;
    sink(std::span(buffer_).subspan(at, length));
    garbage_run_ = 0;
    at += length;
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(at));
  return true;
}

}  // namespace kinemap
