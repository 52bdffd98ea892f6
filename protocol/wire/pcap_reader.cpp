// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/file.hpp"
#include "protocol/wire/ip_fragments.hpp"
#include "protocol/wire/pcap.hpp"

namespace kinemap {

namespace {

constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kRecordHeader = 16;
constexpr std::uint32_t kLargestRecord = 262144;  // libpcap's own limit

std::uint32_t swapped(std::uint32_t v) { return v >> 24U | (v >> 8U & 0xff00U) | (v << 8U & 0xff0000U) | v << 24U; }

struct Format {
  bool little_endian = false;
  double fraction = 1e-6;
};

std::optional<Format> format_of(std::uint32_t magic) {
  switch (magic) {
    case 0xa1b2c3d4:
      return Format{false, 1e-6};
    case 0xd4c3b2a1:
      return Format{true, 1e-6};
    case 0xa1b23c4d:
      return Format{false, 1e-9};
    case 0x4d3cb2a1:
      return Format{true, 1e-9};
    default:
      return std::nullopt;
  }
}

}  // namespace

class PcapReader::Impl {
 public:
  std::string path;
  File file;
  std::uint64_t size = 0;
  Format format;
  std::uint32_t link_type = 0;
  PcapStats stats;
  bool finished = false;
  std::vector<std::byte> record;
  ip::FragmentTable fragments;

  [[nodiscard]] Error damaged(const std::string& what) {
    finish();
    return Error{path + ": byte " + std::to_string(stats.bytes_read) + ": " + what};
  }

  void finish() {
    finished = true;
    fragments.clear();
    stats.fragments_unfinished = fragments.unfinished();
  }

  std::size_t read(std::span<std::byte> into) { return std::fread(into.data(), 1, into.size(), file.get()); }

  std::optional<Error> open() {
    file.reset(std::fopen(path.c_str(), "rb"));
    if (!file) return Error{path + ": cannot open: " + std::strerror(errno)};
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) return Error{path + ": is a directory, not a capture"};
    size = std::filesystem::file_size(path, error);
    if (error) size = 0;
    std::array<std::byte, kFileHeader> head{};
    const std::size_t got = read(head);
    if (got == 0) return Error{path + ": is empty"};
    return read_header(std::span<const std::byte>(head).first(got));
  }

  std::optional<Error> read_header(std::span<const std::byte> head) {
    BigEndianReader in(head);
    const std::uint32_t magic = in.u32();
    if (in.ok() && magic == 0x0a0d0d0a) {
      return Error{path + ": is a pcapng capture; classic pcap is expected (convert it: editcap -F pcap IN OUT)"};
    }
    const auto known = format_of(magic);
    if (in.ok() && !known) return Error{path + ": byte 0: no pcap magic (a1b2c3d4 or a1b23c4d, either byte order)"};
    if (head.size() < kFileHeader) return Error{path + ": ends within the 24-byte pcap header"};
    format = *known;
    in.take(16);
    link_type = number(in) & 0xffffU;  // the upper bits tell of a frame check sequence
    if (!ip::is_known_link(link_type)) {
      return Error{path + ": byte 20: link type " + std::to_string(link_type) +
                   "; Ethernet (1), raw IP (101), Linux cooked (113, 276) or BSD loopback (0) is expected"};
    }
    stats.bytes_read = kFileHeader;
    return std::nullopt;
  }

  [[nodiscard]] std::uint32_t number(BigEndianReader& in) const {
    const std::uint32_t v = in.u32();
    return format.little_endian ? swapped(v) : v;
  }

  /// Reads one record into `record`; nullopt at the end of the file.
  Result<std::optional<double>> next_record() {
    std::array<std::byte, kRecordHeader> head{};
    const std::size_t got = read(head);
    if (got == 0) {
      finish();
      return std::optional<double>{};
    }
    if (got < kRecordHeader) return damaged("the file ends within a 16-byte packet header");
    BigEndianReader in(head);
    const double seconds = number(in);
    const double time_s = seconds + number(in) * format.fraction;
    const std::uint32_t length = number(in);
    if (length > kLargestRecord) {
      return damaged("a packet of " + std::to_string(length) + " bytes; at most 262144 are possible");
    }
    record.resize(length);
    if (read(record) < length) return damaged("the file ends within a packet of " + std::to_string(length) + " bytes");
    stats.bytes_read += kRecordHeader + length;
    ++stats.records;
    return std::optional<double>{time_s};
  }

  std::optional<UdpPacket> unpack(double time_s) {
    ip::Failure why = ip::Failure::None;
    const auto link = ip::strip_link(link_type, record, why);
    auto packet = link ? ip::parse_ip(*link, why) : std::nullopt;
    std::vector<std::byte> joined;
    if (packet && packet->fragment) {
      ++stats.fragments;
      auto whole = fragments.add(*packet, time_s);
      stats.fragments_unfinished = fragments.unfinished();
      if (!whole) return std::nullopt;
      joined = std::move(whole->bytes);
      packet = whole->packet;
      packet->body = joined;
    }
    const auto udp = packet ? ip::parse_udp(packet->protocol, packet->body, why) : std::nullopt;
    if (!udp) {
      ++(why == ip::Failure::NotUdp ? stats.not_udp : stats.truncated);
      return std::nullopt;
    }
    ++stats.udp;
    return UdpPacket{time_s,
                     ip::endpoint(*packet, udp->source_port),
                     udp->destination_port,
                     {udp->payload.begin(), udp->payload.end()}};
  }
};

PcapReader::PcapReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PcapReader::~PcapReader() = default;
PcapReader::PcapReader(PcapReader&&) noexcept = default;
PcapReader& PcapReader::operator=(PcapReader&&) noexcept = default;

Result<PcapReader> PcapReader::open(const std::string& path) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  if (auto error = impl->open()) return std::move(*error);
  return PcapReader(std::move(impl));
}

Result<std::optional<UdpPacket>> PcapReader::next() {
  while (!impl_->finished) {
    auto time_s = impl_->next_record();
    if (!time_s) return Error{time_s.error()};
    if (!*time_s) break;
    if (auto packet = impl_->unpack(**time_s)) return packet;
  }
  return std::optional<UdpPacket>{};
}

const PcapStats& PcapReader::stats() const { return impl_->stats; }
std::uint64_t PcapReader::file_size() const { return impl_->size; }

}  // namespace kinemap
