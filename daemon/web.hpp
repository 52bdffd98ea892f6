// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "daemon/asio.hpp"
// after Asio with its <utility>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "daemon/api.hpp"
#include "daemon/guests.hpp"
#include "daemon/net_stream.hpp"
#include "daemon/security.hpp"
#include "daemon/server.hpp"
#include "daemon/stream_hub.hpp"

namespace kinemap {

namespace http = beast::http;

namespace foxglove {
class Feed;
}

/// What all connections share; the server's thread only.
struct WebContext {
  Api& api;
  StreamHub& hub;
  foxglove::Feed& foxglove;
  net::thread_pool& workshop;  ///< one thread for what takes long
  Security security;
  Visitors visitors;
  Config::Api config;
  ServerLimits limits;
  Guests guests;

  /// Whether limits by address hold for who comes from there.
  [[nodiscard]] bool limited(const Visitor& visitor) const { return !visitor.local || !security.policy.trusts_local(); }
  /// Whether there are more connections, of all, than `times` what there may be.
  [[nodiscard]] bool crowded(std::size_t connections, std::size_t times = 1) const {
    return connections > times * static_cast<std::size_t>(config.max_clients);
  }
  /// The same of one address.
  [[nodiscard]] bool crowded(const Visitor& visitor, std::size_t connections, std::size_t times = 1) const {
    return limited(visitor) && connections > times * static_cast<std::size_t>(config.max_clients_per_address);
  }
};

/// Reads HTTP requests from the connection and answers them, until it ends or becomes a WebSocket.
void serve_http(net::ip::tcp::socket socket, WebContext& context, ConnectionSlot slot);

/// Turns the connection into a client of the stream.
void serve_stream(NetStream stream, http::request<http::string_body> request, WebContext& context, ConnectionSlot slot);

/// The same for a viewer that speaks the Foxglove protocol; `subprotocol` is the one of its offers that was chosen.
void serve_foxglove(NetStream stream, http::request<http::string_body> request, const std::string& subprotocol,
                    WebContext& context, ConnectionSlot slot);

}  // namespace kinemap
