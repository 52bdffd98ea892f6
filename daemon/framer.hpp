// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace kinemap {

/// Finds the datagrams in a TCP stream of MVN: they stand back to back, each header says how long its payload is (old
/// senders say 0: then the item count does, or the beginning of the next). After bytes that are no header it looks for
/// the next one.
class StreamFramer {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;

  /// Takes the bytes that came and calls `sink` for each datagram that is whole. False when the peer does not speak
  /// this protocol: 64 KiB in a row without a datagram. The stream is to be closed then.
  [[nodiscard]] bool add(std::span<const std::byte> bytes, const Sink& sink);

  /// Bytes that belonged to no datagram.
  [[nodiscard]] std::uint64_t skipped_bytes() const { return skipped_; }

 private:
  [[nodiscard]] std::size_t length_at(std::size_t at) const;
  [[nodiscard]] std::size_t find_magic(std::size_t from) const;

  std::vector<std::byte> buffer_;
  std::uint64_t skipped_ = 0;
  std::size_t garbage_run_ = 0;
};

}  // namespace kinemap
