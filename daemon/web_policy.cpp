// SPDX-License-Identifier: Apache-2.0
#include "daemon/web.hpp"

namespace kinemap {
namespace {

bool same_name(std::string_view a, std::string_view b) {
  return beast::iequals({a.data(), a.size()}, {b.data(), b.size()});
}

std::string_view without_port(std::string_view host) {
  if (host.starts_with('['))
    return host.substr(0, host.find(']') == std::string_view::npos ? host.size() : host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

/// 127.x.y.z; a name that only begins so (127.0.0.1.example.org) is none.
bool is_loopback(std::string_view name) {
  if (same_name(name, "localhost") || name == "[::1]") return true;
  ErrorCode error;
  const auto address = net::ip::make_address_v4(std::string(name), error);
  return !error && address.is_loopback();
}

}  // namespace

bool host_allowed(std::string_view host, bool loopback_only) {
  return !loopback_only || host.empty() || is_loopback(without_port(host));
}

bool origin_allowed(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return same_name(origin.substr(scheme.size()), host);
  return false;
}

bool viewer_origin_allowed(std::string_view origin, std::string_view host) {
  if (origin_allowed(origin, host) || origin == "file://") return true;
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme))
      return is_loopback(without_port(origin.substr(scheme.size()))) && is_loopback(without_port(host));
  return false;
}

}  // namespace kinemap
