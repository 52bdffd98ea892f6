// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace kinemap {

/// An IPv6 address as its 16 bytes; an IPv4 address stands as ::ffff:a.b.c.d, so that both are one kind.
using AddressBytes = std::array<std::uint8_t, 16>;

/// nullopt for what is no address (names are not looked up).
std::optional<AddressBytes> parse_address(const std::string& text);
/// 127.0.0.0/8 or ::1.
bool is_loopback(const AddressBytes& address);

/// All addresses that begin with the same bits: "192.168.1.0/24", "fe80::/10", or one address.
class Network {
 public:
  static std::optional<Network> parse(const std::string& text);
  [[nodiscard]] bool contains(const AddressBytes& address) const;

 private:
  Network(const AddressBytes& first, unsigned bits) : first_(first), bits_(bits) {}
  AddressBytes first_;
  unsigned bits_;  // of 128
};

/// Whether an allow-list lets the address in; an empty list lets everybody in.
bool allows(const std::vector<Network>& list, const AddressBytes& address);

}  // namespace kinemap
