// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/endpoint.hpp"

#include <algorithm>
#include <charconv>

namespace kinemap::cli {

std::string Endpoint::text() const {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

Result<Endpoint> parse_endpoint(const std::string& text, const std::string& default_host, std::uint16_t default_port) {
  const Error error{"\"" + text +
                    "\" is no address: expected host:port, e.g. 127.0.0.1:" + std::to_string(default_port)};
  Endpoint endpoint{default_host, default_port};
  std::string port;
  if (text.starts_with('[')) {
    const auto end = text.find(']');
    if (end == std::string::npos || (end + 1 < text.size() && text[end + 1] != ':')) return error;
    endpoint.host = text.substr(1, end - 1);
    if (end + 1 < text.size()) port = text.substr(end + 1);
  } else if (std::count(text.begin(), text.end(), ':') > 1) {
    endpoint.host = text;  // a bare IPv6 address
  } else {
    const auto colon = text.find(':');
    if (colon != 0 && !text.empty()) endpoint.host = text.substr(0, colon);
    if (colon != std::string::npos) port = text.substr(colon);
  }
  if (!port.empty()) {
    const char* const begin = port.data() + 1;
    const char* const end = port.data() + port.size();
    const auto [next, code] = std::from_chars(begin, end, endpoint.port);
    if (code != std::errc{} || next != end || endpoint.port == 0) return error;
  }
  if (endpoint.host.empty()) return error;
  return endpoint;
}

}  // namespace kinemap::cli
