// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/answer.hpp"
#include "daemon/config.hpp"
#include "daemon/tokens.hpp"

namespace kinemap {

/// What of a request decides whether it is answered, be it HTTP or the upgrade to a WebSocket. It can be kept: of the
/// token there is the hash only.
struct WebVisit {
  bool local = false;              ///< the peer is this machine
  bool tls = false;                ///< over TLS
  bool upgrade = false;            ///< asks for a WebSocket
  bool viewer = false;             ///< … to speak the Foxglove protocol
  bool open = false;               ///< the path is for everybody: the live page, which then asks for the token
  bool changes = false;            ///< a method other than GET and HEAD
  bool token_in_query = false;     ///< ?token=…
  std::string host;                ///< header
  std::string origin;              ///< the same; "" where there is none: no browser
  std::optional<TokenHash> token;  ///< that it shows
};

/// The token of "Bearer TOKEN"; empty where there is none.
std::string_view bearer_token(std::string_view authorization);

/// Who may ask what. The one place that decides it, for HTTP, the stream and Foxglove alike; docs/security.md says what
/// it promises.
class WebPolicy {
 public:
  /// `loopback_only`: the server is bound to a loopback address. `tls`: it has a certificate.
  WebPolicy(const Config::Api& config, Tokens tokens, bool loopback_only, bool tls);

  /// Why the request is not answered; nullopt when it is.
  [[nodiscard]] std::optional<ApiError> refusal(const WebVisit& visit) const;
  /// What it may do; scope admin for who needs no token.
  [[nodiscard]] Scope scope_of(const WebVisit& visit) const;
  /// Programs of this machine need no token, and are not held to what one address may do.
  [[nodiscard]] bool trusts_local() const { return auth_ == "remote"; }

 private:
  [[nodiscard]] bool host_allowed(std::string_view host) const;
  [[nodiscard]] bool origin_allowed(const WebVisit& visit) const;
  [[nodiscard]] std::optional<ApiError> refusal_by_place(const WebVisit& visit) const;
  [[nodiscard]] std::optional<ApiError> refusal_by_token(const WebVisit& visit) const;

  std::string auth_;
  Tokens tokens_;
  bool loopback_only_;
  bool tls_;
  std::vector<std::string> names_;  // of this machine
  std::vector<std::string> origins_;
};

}  // namespace kinemap
