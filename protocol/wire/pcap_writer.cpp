// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cmath>
#include <cstring>

#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/file.hpp"
#include "protocol/wire/pcap.hpp"

namespace kinemap {

namespace {

constexpr std::uint32_t kLoopback = 0x7f000001;
constexpr std::uint16_t kSourcePort = 50000;  // any; MVN's own is ephemeral
constexpr std::size_t kMaxPayload = 65535 - 20 - 8;

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

/// Ethernet + IPv4 + UDP around one payload, both checksums filled in.
std::vector<std::byte> frame(std::uint16_t port, std::uint16_t id, std::span<const std::byte> payload) {
  const auto udp_length = static_cast<std::uint16_t>(8 + payload.size());
  const auto ip_length = static_cast<std::uint16_t>(20 + udp_length);
  BigEndianWriter ip;
  const auto put_ip = [&](std::uint16_t sum) {
    ip.u16(0x4500);
    ip.u16(ip_length);
    ip.u16(id);
    ip.u16(0x4000);  // do not fragment
    ip.u16(0x4011);  // 64 hops, UDP
    ip.u16(sum);
    ip.u32(kLoopback);
    ip.u32(kLoopback);
  };
  put_ip(0);
  const std::uint16_t ip_sum = checksum(word_sum(ip.view(), 0));
  std::uint32_t udp_sum = 2 * ((kLoopback >> 16U) + (kLoopback & 0xffffU)) + 17U + 2U * udp_length + kSourcePort + port;
  const std::uint16_t udp_checksum = checksum(word_sum(payload, udp_sum));

  BigEndianWriter out;
  for (int i = 0; i < 12; ++i) out.u8(0);
  out.u16(0x0800);
  ip = BigEndianWriter{};
  put_ip(ip_sum);
  out.bytes(ip.view());
  out.u16(kSourcePort);
  out.u16(port);
  out.u16(udp_length);
  out.u16(udp_checksum == 0 ? std::uint16_t{0xffff} : udp_checksum);
  out.bytes(payload);
  return out.release();
}

template <class T>
bool put_native(std::FILE* file, T value) {
  return std::fwrite(&value, sizeof value, 1, file) == 1;
}

}  // namespace

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
  std::FILE* f = impl->file.get();
  // Written in the machine's byte order, as the format has it: the magic tells readers which.
  const bool ok = put_native<std::uint32_t>(f, 0xa1b2c3d4) && put_native<std::uint16_t>(f, 2) &&
                  put_native<std::uint16_t>(f, 4) && put_native<std::uint32_t>(f, 0) &&
                  put_native<std::uint32_t>(f, 0) && put_native<std::uint32_t>(f, 262144) &&
                  put_native<std::uint32_t>(f, 1);
  if (!ok) return Error{path + ": cannot write: " + std::strerror(errno)};
  return PcapWriter(std::move(impl));
}

bool PcapWriter::write(double time_s, std::span<const std::byte> payload) {
  if (impl_->error || !impl_->file) return false;
  if (payload.size() > kMaxPayload || !std::isfinite(time_s) || time_s < 0.0 || time_s >= 4294967295.0) {
    impl_->error = Error{impl_->path + ": cannot write: a packet needs a time of 0–2³² s and at most " +
                         std::to_string(kMaxPayload) + " bytes"};
    return false;
  }
  const auto time_us = static_cast<std::uint64_t>(std::llround(time_s * 1e6));
  const auto bytes = frame(impl_->port, impl_->next_id++, payload);
  const auto length = static_cast<std::uint32_t>(bytes.size());
  std::FILE* f = impl_->file.get();
  const bool ok = put_native(f, static_cast<std::uint32_t>(time_us / 1'000'000)) &&
                  put_native(f, static_cast<std::uint32_t>(time_us % 1'000'000)) && put_native(f, length) &&
                  put_native(f, length) && std::fwrite(bytes.data(), 1, bytes.size(), f) == bytes.size();
  return ok || impl_->failed();
}

std::optional<Error> PcapWriter::close() {
  if (impl_->file && std::fclose(impl_->file.release()) != 0) impl_->failed();
  return impl_->error;
}

}  // namespace kinemap
