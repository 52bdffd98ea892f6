// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/ip_packet.hpp"

#include <arpa/inet.h>

#include <algorithm>

#include "protocol/wire/big_endian.hpp"

namespace kinemap::ip {

namespace {

// Link types: https://www.tcpdump.org/linktypes.html
constexpr std::uint32_t kNull = 0, kEthernet = 1, kRaw = 101, kRawBsd = 12, kRawOpenBsd = 14, kLoop = 108,
                        kCooked = 113;
constexpr std::uint32_t kIpv4Only = 228, kIpv6Only = 229, kCooked2 = 276;
constexpr std::uint16_t kTypeIpv4 = 0x0800, kTypeIpv6 = 0x86dd;
constexpr std::uint8_t kHopByHop = 0, kUdp = 17, kRouting = 43, kFragment = 44, kAuthentication = 51, kDestination = 60;

std::optional<std::span<const std::byte>> fail(Failure& why, Failure what) {
  why = what;
  return std::nullopt;
}

std::span<const std::byte> rest(BigEndianReader in) { return in.take(in.remaining()); }

/// After an EtherType: skips VLAN tags (802.1Q, 802.1ad and their precursor).
std::optional<std::span<const std::byte>> after_ether_type(std::uint16_t type, BigEndianReader in, Failure& why) {
  while (in.ok() && (type == 0x8100 || type == 0x88a8 || type == 0x9100)) {
    in.u16();
    type = in.u16();
  }
  if (!in.ok()) return fail(why, Failure::Truncated);
  if (type != kTypeIpv4 && type != kTypeIpv6) return fail(why, Failure::NotUdp);
  return rest(in);
}

/// BSD loopback: an address family in the byte order of the capturing machine, which may not be ours.
std::optional<std::span<const std::byte>> after_family(BigEndianReader in, Failure& why) {
  std::uint32_t family = in.u32();
  if (!in.ok()) return fail(why, Failure::Truncated);
  if (family > 0xffff) family = family >> 24U | (family >> 8U & 0xff00U);
  // 2 is IPv4 everywhere; IPv6 is 24, 28 or 30 on the BSDs and macOS, 10 on Linux, 23 on Windows.
  const bool known = family == 2 || family == 10 || family == 23 || family == 24 || family == 28 || family == 30;
  if (!known) return fail(why, Failure::NotUdp);
  return rest(in);
}

std::optional<Packet> parse_ipv4(std::span<const std::byte> bytes, Failure& why) {
  BigEndianReader in(bytes);
  const std::size_t header = (in.u8() & 0x0fU) * 4U;
  in.u8();
  std::size_t total = in.u16();
  Packet out;
  out.fragment_id = in.u16();
  const std::uint16_t flags = in.u16();
  in.u8();
  out.protocol = in.u8();
  in.u16();
  const auto source = in.take(4);
  const auto destination = in.take(4);
  if (total == 0) total = bytes.size();  // segmentation left to the network card: the capture has the real length
  why = Failure::Truncated;
  if (!in.ok() || header < 20 || total < header || total > bytes.size()) return std::nullopt;
  std::copy(source.begin(), source.end(), out.source.begin());
  std::copy(destination.begin(), destination.end(), out.destination.begin());
  out.body = bytes.subspan(header, total - header);
  out.more_fragments = (flags & 0x2000U) != 0;
  out.fragment_offset = (flags & 0x1fffU) * 8U;
  out.fragment = out.more_fragments || out.fragment_offset != 0;
  why = Failure::None;
  return out;
}

/// Length of the IPv6 extension header at `in`, of the kinds that have their length in the second byte.
std::size_t extension_length(std::uint8_t kind, std::uint8_t length_field) {
  return kind == kAuthentication ? (length_field + 2U) * 4U : (length_field + 1U) * 8U;
}

bool is_extension(std::uint8_t kind) {
  return kind == kHopByHop || kind == kRouting || kind == kDestination || kind == kAuthentication;
}

/// Moves past extension headers; false when they run past the end.
bool skip_extensions(std::uint8_t& kind, std::span<const std::byte>& body) {
  while (is_extension(kind)) {
    if (body.size() < 8) return false;
    const std::size_t length = extension_length(kind, std::to_integer<std::uint8_t>(body[1]));
    if (length > body.size()) return false;
    kind = std::to_integer<std::uint8_t>(body[0]);
    body = body.subspan(length);
  }
  return true;
}

std::optional<Packet> parse_ipv6(std::span<const std::byte> bytes, Failure& why) {
  BigEndianReader in(bytes);
  in.u32();
  const std::size_t length = in.u16();
  Packet out;
  out.version = 6;
  out.protocol = in.u8();
  in.u8();
  const auto source = in.take(16);
  const auto destination = in.take(16);
  why = Failure::Truncated;
  if (!in.ok() || length > in.remaining()) return std::nullopt;
  std::copy(source.begin(), source.end(), out.source.begin());
  std::copy(destination.begin(), destination.end(), out.destination.begin());
  out.body = in.take(length);
  if (!skip_extensions(out.protocol, out.body)) return std::nullopt;
  if (out.protocol == kFragment) {
    BigEndianReader head(out.body);
    out.protocol = head.u8();
    head.u8();
    const std::uint16_t offset = head.u16();
    out.fragment_id = head.u32();
    if (!head.ok()) return std::nullopt;
    out.body = rest(head);
    out.fragment_offset = offset & 0xfff8U;
    out.more_fragments = (offset & 1U) != 0;
    out.fragment = out.more_fragments || out.fragment_offset != 0;  // else an "atomic" fragment: whole (RFC 6946)
  }
  why = Failure::None;
  return out;
}

}  // namespace

bool is_known_link(std::uint32_t t) {
  constexpr std::array kKnown{kNull, kEthernet, kRaw,      kRawBsd,   kRawOpenBsd,
                              kLoop, kCooked,   kIpv4Only, kIpv6Only, kCooked2};
  return std::find(kKnown.begin(), kKnown.end(), t) != kKnown.end();
}

std::optional<std::span<const std::byte>> strip_link(std::uint32_t link_type, std::span<const std::byte> frame,
                                                     Failure& why) {
  BigEndianReader in(frame);
  switch (link_type) {
    case kNull:
    case kLoop:
      return after_family(in, why);
    case kEthernet: {
      in.take(12);
      const std::uint16_t type = in.u16();
      return after_ether_type(type, in, why);
    }
    case kCooked: {
      in.take(14);
      const std::uint16_t type = in.u16();
      return after_ether_type(type, in, why);
    }
    case kCooked2: {
      const std::uint16_t type = in.u16();
      in.take(18);
      return after_ether_type(type, in, why);
    }
    default:
      return frame;
  }
}

std::optional<Packet> parse_ip(std::span<const std::byte> bytes, Failure& why) {
  why = Failure::Truncated;
  if (bytes.empty()) return std::nullopt;
  switch (std::to_integer<unsigned>(bytes[0]) >> 4U) {
    case 4:
      return parse_ipv4(bytes, why);
    case 6:
      return parse_ipv6(bytes, why);
    default:
      why = Failure::NotUdp;
      return std::nullopt;
  }
}

std::optional<Udp> parse_udp(std::uint8_t protocol, std::span<const std::byte> body, Failure& why) {
  why = Failure::Truncated;
  if (!skip_extensions(protocol, body)) return std::nullopt;
  if (protocol != kUdp) {
    why = Failure::NotUdp;
    return std::nullopt;
  }
  BigEndianReader in(body);
  Udp out;
  out.source_port = in.u16();
  out.destination_port = in.u16();
  const std::size_t length = in.u16();
  in.u16();  // checksum: network cards fill it in after the capture, so a capture's is often wrong
  if (!in.ok() || length < 8 || length - 8 > in.remaining()) return std::nullopt;
  out.payload = in.take(length - 8);
  why = Failure::None;
  return out;
}

std::string endpoint(const Packet& packet, std::uint16_t port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const int family = packet.version == 4 ? AF_INET : AF_INET6;
  inet_ntop(family, packet.source.data(), text.data(), text.size());
  const std::string address(text.data());
  return (packet.version == 4 ? address : '[' + address + ']') + ':' + std::to_string(port);
}

}  // namespace kinemap::ip
