// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/wire/ip_packet.hpp"

namespace kinemap::ip {

/// Puts IP fragments together, in any order (RFC 791, RFC 8200). Bounded: at most kMost datagrams of 64 KiB wait, none
/// for longer than kLongest; those given up are counted. Fragments that overlap make the datagram unusable (RFC 5722);
/// plain repeats do no harm.
class FragmentTable {
 public:
  static constexpr std::size_t kMost = 64;
  static constexpr double kLongestS = 30.0;

  struct Whole {
    Packet packet;  ///< of the first fragment; its `body` is to be taken from `bytes`
    std::vector<std::byte> bytes;
  };

  /// Takes one fragment; gives the datagram that it completes.
  std::optional<Whole> add(const Packet& fragment, double time_s);
  /// Datagrams given up so far.
  [[nodiscard]] std::uint64_t unfinished() const { return unfinished_; }
  /// Gives up what still waits.
  void clear();

 private:
  struct Part {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  struct Pending {
    Packet first;
    double since_s = 0.0;
    std::vector<std::byte> bytes;
    std::vector<Part> parts;  ///< sorted, disjoint
    std::optional<std::size_t> length;
    bool spoilt = false;
  };

  Pending& pending_for(const Packet& fragment, double time_s);
  static void place(Pending& pending, const Packet& fragment);
  static bool is_whole(const Pending& pending);

  std::deque<Pending> pending_;  ///< oldest first
  std::uint64_t unfinished_ = 0;
};

}  // namespace kinemap::ip
