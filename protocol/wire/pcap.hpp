// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap {

/// One UDP payload out of a capture (or off a socket).
struct UdpPacket {
  double time_s = 0.0;  ///< capture time, seconds since the epoch of the capture's clock
  std::string source;   ///< "address:port"
  std::uint16_t destination_port = 0;
  std::vector<std::byte> payload;
};

struct PcapStats {
  std::uint64_t records = 0;
  std::uint64_t udp = 0;
  std::uint64_t not_udp = 0;    ///< ARP, TCP, …
  std::uint64_t truncated = 0;  ///< snap length cut the packet, or lengths inside it disagree
  std::uint64_t fragments = 0;
  std::uint64_t fragments_unfinished = 0;  ///< datagrams of which a part never came
  std::uint64_t bytes_read = 0;
};

/// Reads classic libpcap files: µs and ns, both byte orders; Ethernet (with VLAN tags), raw IP, Linux cooked v1 and v2,
/// BSD loopback; IPv4 and IPv6 UDP; IP fragments are put together.
class PcapReader {
 public:
  static Result<PcapReader> open(const std::string& path);
  ~PcapReader();
  PcapReader(PcapReader&&) noexcept;
  PcapReader& operator=(PcapReader&&) noexcept;

  /// Next UDP packet; nullopt at the end of the file; an Error (path, byte offset, what was expected) when it is
  /// damaged there.
  Result<std::optional<UdpPacket>> next();
  [[nodiscard]] const PcapStats& stats() const;
  [[nodiscard]] std::uint64_t file_size() const;

 private:
  class Impl;
  explicit PcapReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The first bytes of a classic µs libpcap file of Ethernet frames, in this machine's byte order.
std::string pcap_file_header();
/// One UDP datagram as a packet of such a file. `source`: "address:port" of IPv4, or "[address]:port" of IPv6; it goes
/// to this machine's `port`. Empty when it cannot be one: more than 65,507 bytes (65,527 with IPv6), or a time outside
/// 0–2³² s.
std::string pcap_packet(double time_s, const std::string& source, std::uint16_t port,
                        std::span<const std::byte> payload);

/// Writes a classic µs libpcap file of IPv4/UDP packets over Ethernet (127.0.0.1 → 127.0.0.1:port).
class PcapWriter {
 public:
  static Result<PcapWriter> create(const std::string& path, std::uint16_t port);
  ~PcapWriter();
  PcapWriter(PcapWriter&&) noexcept;
  PcapWriter& operator=(PcapWriter&&) noexcept;
  /// False when the file could not be written (disk full); `close` says why.
  bool write(double time_s, std::span<const std::byte> payload);
  std::optional<Error> close();

 private:
  class Impl;
  explicit PcapWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
