// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/file.hpp"
#include "protocol/wire/pcap.hpp"

namespace kinemap {

namespace {

constexpr const char* kSource = "127.0.0.1:50000";  // any port; MVN's own is ephemeral
constexpr std::size_t kMaxPayload = 65535 - 20 - 8;

/// Where a datagram came from and went to: IPv4 has the first 4 bytes.
struct Way {
  bool v6 = false;
  std::array<std::byte, 16> from{}, to{};
  std::uint16_t from_port = 0, to_port = 0;
  [[nodiscard]] std::span<const std::byte> source() const { return std::span(from).first(v6 ? 16 : 4); }
  [[nodiscard]] std::span<const std::byte> destination() const { return std::span(to).first(v6 ? 16 : 4); }
};

/// What is no address comes from this machine.
Way way_of(const std::string& source, std::uint16_t port) {
  Way way;
  way.to_port = port;
  const auto colon = source.rfind(':');
  std::string address = source.substr(0, colon);
  if (colon != std::string::npos)
    std::from_chars(source.data() + colon + 1, source.data() + source.size(), way.from_port);
  way.v6 = address.size() > 2 && address.front() == '[' && address.back() == ']';
  if (way.v6)
    address = address.substr(1, address.find('%') == std::string::npos ? address.size() - 2 : address.find('%') - 1);
  ::inet_pton(way.v6 ? AF_INET6 : AF_INET, way.v6 ? "::1" : "127.0.0.1", way.to.data());
  if (::inet_pton(way.v6 ? AF_INET6 : AF_INET, address.c_str(), way.from.data()) != 1) way.from = way.to;
  return way;
}

/// One's complement sum of 16-bit words (RFC 1071), before the final complement.
std::uint32_t word_sum(std::span<const std::byte> bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto b = std::to_integer<std::uint32_t>(bytes[i]);
    sum += i % 2 == 0 ? b << 8U : b;
  }
  return sum;
}

std::uint16_t checksum(std::uint32_t sum) {
  while (sum >> 16U) sum = (sum & 0xffffU) + (sum >> 16U);
  return static_cast<std::uint16_t>(~sum & 0xffffU);
}

std::vector<std::byte> ipv4_header(const Way& way, std::uint16_t udp_length, std::uint16_t id) {
  std::vector<std::byte> bytes;
  for (std::uint16_t sum = 0, round = 0; round < 2; ++round) {
    BigEndianWriter ip;
    ip.u16(0x4500);
    ip.u16(static_cast<std::uint16_t>(20 + udp_length));
    ip.u16(id);
    ip.u16(0x4000);  // do not fragment
    ip.u16(0x4011);  // 64 hops, UDP
    ip.u16(sum);
    ip.bytes(way.source());
    ip.bytes(way.destination());
    sum = checksum(word_sum(ip.view(), 0));
    bytes = ip.release();
  }
  return bytes;
}

std::vector<std::byte> ipv6_header(const Way& way, std::uint16_t udp_length) {
  BigEndianWriter ip;
  ip.u32(0x60000000);
  ip.u16(udp_length);
  ip.u16(0x1140);  // UDP, 64 hops
  ip.bytes(way.source());
  ip.bytes(way.destination());
  return ip.release();
}

/// Ethernet + IP + UDP around one payload, the checksums filled in.
std::vector<std::byte> frame(const Way& way, std::uint16_t id, std::span<const std::byte> payload) {
  const auto udp_length = static_cast<std::uint16_t>(8 + payload.size());
  std::uint32_t sum = word_sum(way.source(), word_sum(way.destination(), 17U + 2U * udp_length));
  sum = word_sum(payload, sum + way.from_port + way.to_port);
  const std::uint16_t udp_checksum = checksum(sum);

  BigEndianWriter out;
  for (int i = 0; i < 12; ++i) out.u8(0);
  out.u16(way.v6 ? 0x86dd : 0x0800);
  out.bytes(way.v6 ? ipv6_header(way, udp_length) : ipv4_header(way, udp_length, id));
  out.u16(way.from_port);
  out.u16(way.to_port);
  out.u16(udp_length);
  out.u16(udp_checksum == 0 ? std::uint16_t{0xffff} : udp_checksum);
  out.bytes(payload);
  return out.release();
}

template <class T>
void put_native(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string packet(double time_s, const Way& way, std::uint16_t id, std::span<const std::byte> payload) {
  if (payload.size() > kMaxPayload + (way.v6 ? 20 : 0) || !std::isfinite(time_s) || time_s < 0.0 ||
      time_s >= 4294967295.0)
    return {};
  const auto time_us = static_cast<std::uint64_t>(std::llround(time_s * 1e6));
  const auto bytes = frame(way, id, payload);
  std::string out;
  put_native(out, static_cast<std::uint32_t>(time_us / 1'000'000));
  put_native(out, static_cast<std::uint32_t>(time_us % 1'000'000));
  put_native(out, static_cast<std::uint32_t>(bytes.size()));
  put_native(out, static_cast<std::uint32_t>(bytes.size()));
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return out;
}

bool put(std::FILE* file, const std::string& bytes) {
  return std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
}

}  // namespace

std::string pcap_file_header() {
  // Written in the machine's byte order, as the format has it: the magic tells readers which.
  std::string out;
  put_native<std::uint32_t>(out, 0xa1b2c3d4);
  put_native<std::uint16_t>(out, 2);
  put_native<std::uint16_t>(out, 4);
  put_native<std::uint32_t>(out, 0);
  put_native<std::uint32_t>(out, 0);
  put_native<std::uint32_t>(out, 262144);
  put_native<std::uint32_t>(out, 1);
  return out;
}

std::string pcap_packet(double time_s, const std::string& source, std::uint16_t port,
                        std::span<const std::byte> payload) {
  return packet(time_s, way_of(source, port), 0, payload);
}

class PcapWriter::Impl {
 public:
  std::string path;
  File file;
  std::uint16_t port = 0;
  std::uint16_t next_id = 0;
  std::optional<Error> error;

  bool failed() {
    if (!error) error = Error{path + ": cannot write: " + std::strerror(errno)};
    return false;
  }
};

PcapWriter::PcapWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PcapWriter::~PcapWriter() = default;
PcapWriter::PcapWriter(PcapWriter&&) noexcept = default;
PcapWriter& PcapWriter::operator=(PcapWriter&&) noexcept = default;

Result<PcapWriter> PcapWriter::create(const std::string& path, std::uint16_t port) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->port = port;
  impl->file.reset(std::fopen(path.c_str(), "wb"));
  if (!impl->file) return Error{path + ": cannot create: " + std::strerror(errno)};
  if (!put(impl->file.get(), pcap_file_header())) return Error{path + ": cannot write: " + std::strerror(errno)};
  return PcapWriter(std::move(impl));
}

bool PcapWriter::write(double time_s, std::span<const std::byte> payload) {
  if (impl_->error || !impl_->file) return false;
  const std::string bytes = packet(time_s, way_of(kSource, impl_->port), impl_->next_id++, payload);
  if (bytes.empty()) {
    impl_->error = Error{impl_->path + ": cannot write: a packet needs a time of 0–2³² s and at most " +
                         std::to_string(kMaxPayload) + " bytes"};
    return false;
  }
  return put(impl_->file.get(), bytes) || impl_->failed();
}

std::optional<Error> PcapWriter::close() {
  if (impl_->file && std::fclose(impl_->file.release()) != 0) impl_->failed();
  return impl_->error;
}

}  // namespace kinemap
