// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

/// From a captured packet to the UDP datagram in it. Everything is a view into the packet.
namespace kinemap::ip {

using Address = std::array<std::byte, 16>;  ///< IPv4 addresses in the first four bytes

/// What a packet carries above IP: the whole upper-layer packet, or one fragment of it.
struct Packet {
  int version = 4;
  Address source{};
  Address destination{};
  std::uint8_t protocol = 0;  ///< of the first byte of `body`: UDP is 17, IPv6 may have extension headers before it
  std::span<const std::byte> body;
  bool fragment = false;
  std::uint32_t fragment_id = 0;
  std::size_t fragment_offset = 0;  ///< bytes
  bool more_fragments = false;
};

struct Udp {
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::span<const std::byte> payload;
};

enum class Failure : std::uint8_t { None, NotUdp, Truncated };

/// pcap link types that `strip_link` understands.
bool is_known_link(std::uint32_t link_type);
/// Strips Ethernet (with VLAN tags), Linux cooked v1/v2, BSD loopback or nothing; nullopt and a Failure when no IP is
/// in it.
std::optional<std::span<const std::byte>> strip_link(std::uint32_t link_type, std::span<const std::byte> frame,
                                                     Failure& why);
std::optional<Packet> parse_ip(std::span<const std::byte> bytes, Failure& why);
/// Skips IPv6 extension headers up to a UDP header. `protocol` and `body` as in Packet.
std::optional<Udp> parse_udp(std::uint8_t protocol, std::span<const std::byte> body, Failure& why);

/// "192.0.2.1:9763", "[2001:db8::1]:9763"
std::string endpoint(const Packet& packet, std::uint16_t port);

}  // namespace kinemap::ip
