// SPDX-License-Identifier: Apache-2.0
#include "daemon/web_policy.hpp"

#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "daemon/network.hpp"

namespace kinemap {
namespace {

bool same_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

bool contains_name(const std::vector<std::string>& list, std::string_view name) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& item) { return same_name(item, name); });
}

/// "[::1]:8765" → "::1", "localhost:8765" → "localhost".
std::string_view without_port(std::string_view host) {
  if (!host.starts_with('[')) return host.substr(0, host.find(':'));
  const auto end = host.find(']');
  return end == std::string_view::npos ? host : host.substr(1, end - 1);
}

/// 127.x.y.z; a name that only begins so (127.0.0.1.example.org) is none.
bool is_loopback_name(std::string_view name) {
  if (same_name(name, "localhost")) return true;
  const auto address = parse_address(std::string(name));
  return address && is_loopback(*address);
}

/// The host of "https://host:port"; empty when it is of no web page ("null", "file://").
std::string_view host_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  return {};
}

}  // namespace

std::string_view bearer_token(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  if (!same_name(authorization.substr(0, kScheme.size()), kScheme)) return {};
  return authorization.substr(kScheme.size());
}

WebPolicy::WebPolicy(const Config::Api& config, Tokens tokens, bool loopback_only, bool tls)
    : auth_(config.auth),
      tokens_(std::move(tokens)),
      loopback_only_(loopback_only),
      tls_(tls),
      names_(config.allowed_hosts),
      origins_(config.allowed_origins) {
  std::array<char, 256> name{};
  if (loopback_only || ::gethostname(name.data(), name.size() - 1) != 0) return;
  names_.emplace_back(name.data());
  names_.push_back(names_.back() + ".local");
}

/// A web page can point a name of its own at any address (DNS rebinding), but it cannot make the browser send another
/// name than that one: what names this machine by its address or by a name that it knows comes from no such page.
bool WebPolicy::host_allowed(std::string_view host) const {
  const auto name = without_port(host);
  if (host.empty() || is_loopback_name(name) || contains_name(names_, name)) return true;
  return !loopback_only_ && parse_address(std::string(name)).has_value();
}

/// WebSockets are not bound by the browser's same-origin rule, so the server holds it. Viewers come as desktop programs
/// (their pages are files), from another program of this machine, or from an origin that the configuration names.
bool WebPolicy::origin_allowed(const WebVisit& visit) const {
  if (visit.origin.empty() || contains_name(origins_, visit.origin)) return true;
  if (visit.viewer && visit.origin == "file://") return true;
  const auto host = host_of(visit.origin);
  if (host.empty()) return false;
  if (same_name(host, visit.host)) return true;
  return visit.viewer && is_loopback_name(without_port(host)) && is_loopback_name(without_port(visit.host));
}

std::optional<ApiError> WebPolicy::refusal_by_place(const WebVisit& visit) const {
  if (!host_allowed(visit.host))
    return ApiError{403, "forbidden_host",
                    loopback_only_
                        ? "this server answers to localhost only; `kinemap pair` opens it to other machines"
                        : "this server answers to its addresses and names only; api.allowed_hosts adds names"};
  if ((visit.upgrade || visit.changes) && !origin_allowed(visit))
    return ApiError{403, "forbidden_origin",
                    "pages of other hosts may not open the stream; api.allowed_origins names those that may"};
  if (tls_ && !visit.tls && !(visit.local && trusts_local()))
    return ApiError{400, "tls_required", "this port speaks TLS: https://, wss://"};
  if (visit.token_in_query && !visit.upgrade)
    return ApiError{400, "token_in_query",
                    "?token= is for WebSockets only; send the header Authorization: Bearer TOKEN"};
  return std::nullopt;
}

Scope WebPolicy::scope_of(const WebVisit& visit) const {
  if (auth_ == "none") return Scope::Admin;
  // Who names it otherwise may come through a proxy on this machine.
  if (trusts_local() && visit.local && (visit.host.empty() || is_loopback_name(without_port(visit.host))))
    return Scope::Admin;
  return visit.token ? tokens_.scope_of(*visit.token) : Scope::Nothing;
}

std::optional<ApiError> WebPolicy::refusal_by_token(const WebVisit& visit) const {
  if (visit.open && !visit.changes && !visit.upgrade) return std::nullopt;
  const Scope scope = scope_of(visit);
  if (scope == Scope::Nothing && !visit.token)
    return ApiError{401, "token_missing", "send a token: Authorization: Bearer TOKEN"};
  if (scope == Scope::Nothing) return ApiError{401, "token_wrong", "the token is none that this server knows"};
  if (visit.changes && scope != Scope::Admin)
    return ApiError{403, "token_reads_only", "the token is for reading; this needs one of scope admin"};
  return std::nullopt;
}

std::optional<ApiError> WebPolicy::refusal(const WebVisit& visit) const {
  if (auto error = refusal_by_place(visit)) return error;
  return refusal_by_token(visit);
}

}  // namespace kinemap
