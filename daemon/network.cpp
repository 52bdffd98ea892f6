// SPDX-License-Identifier: Apache-2.0
#include "daemon/network.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace kinemap {
namespace {

constexpr unsigned kV4Prefix = 96;  // bits of ::ffff:0:0, behind which IPv4 stands

}  // namespace

std::optional<AddressBytes> parse_address(const std::string& text) {
  AddressBytes bytes{};
  if (inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1) return bytes;
  bytes[10] = bytes[11] = 0xff;
  if (inet_pton(AF_INET, text.c_str(), bytes.data() + 12) == 1) return bytes;
  return std::nullopt;
}

bool is_loopback(const AddressBytes& address) {
  static const Network v4 = *Network::parse("127.0.0.0/8"), v6 = *Network::parse("::1");
  return v4.contains(address) || v6.contains(address);
}

std::optional<Network> Network::parse(const std::string& text) {
  const auto slash = text.find('/');
  const auto first = parse_address(text.substr(0, slash));
  if (!first) return std::nullopt;
  const unsigned before = text.find(':') == std::string::npos ? kV4Prefix : 0;
  unsigned bits = 128 - before;
  if (slash != std::string::npos) {
    const char* const begin = text.data() + slash + 1;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(begin, end, bits);
    if (error != std::errc{} || stop != end || bits > 128 - before) return std::nullopt;
  }
  return Network(*first, before + bits);
}

bool Network::contains(const AddressBytes& address) const {
  const unsigned whole = bits_ / 8, rest = bits_ % 8;
  if (!std::equal(first_.begin(), first_.begin() + whole, address.begin())) return false;
  return rest == 0 || ((first_[whole] ^ address[whole]) >> (8 - rest)) == 0;
}

bool allows(const std::vector<Network>& list, const AddressBytes& address) {
  return list.empty() ||
         std::any_of(list.begin(), list.end(), [&](const Network& network) { return network.contains(address); });
}

}  // namespace kinemap
