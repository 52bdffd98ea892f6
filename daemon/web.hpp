// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "daemon/asio.hpp"
// after Asio with its <utility>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "daemon/api.hpp"
#include "daemon/stream_hub.hpp"

namespace kinemap {

namespace beast = boost::beast;
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
  std::size_t max_clients;
  std::size_t client_buffer_bytes;
  std::chrono::milliseconds stall;  ///< ServerLimits::stall
  bool loopback_only;               ///< bound to a loopback address
};

/// Counts a connection for as long as it lives.
class ConnectionSlot {
 public:
  explicit ConnectionSlot(ApiCounts& counts) : counts_(&counts) { ++counts_->connections; }
  ConnectionSlot(ConnectionSlot&& other) noexcept : counts_(std::exchange(other.counts_, nullptr)) {}
  ConnectionSlot& operator=(ConnectionSlot&&) = delete;
  ~ConnectionSlot() {
    if (counts_ != nullptr) --counts_->connections;
  }

 private:
  ApiCounts* counts_;
};

/// Reads HTTP requests from the connection and answers them, until it ends or becomes a WebSocket.
void serve_http(net::ip::tcp::socket socket, WebContext& context, ConnectionSlot slot);

/// Turns the connection into a client of the stream.
void serve_stream(beast::tcp_stream stream, http::request<http::string_body> request, WebContext& context,
                  ConnectionSlot slot);

/// The same for a viewer that speaks the Foxglove protocol; `subprotocol` is the one of its offers that was chosen.
void serve_foxglove(beast::tcp_stream stream, http::request<http::string_body> request, const std::string& subprotocol,
                    WebContext& context, ConnectionSlot slot);

/// A server on a loopback address answers only to loopback names: else a web page could point a name of its own at
/// 127.0.0.1 and read the map from the browser of whoever visits it (DNS rebinding).
bool host_allowed(std::string_view host, bool loopback_only);
/// WebSockets are not bound by the browser's same-origin rule, so the server holds it: no Origin (no browser), or the
/// same host.
bool origin_allowed(std::string_view origin, std::string_view host);
/// The same for viewers, which come as desktop programs (their pages are files) or are served by another program of
/// this machine.
bool viewer_origin_allowed(std::string_view origin, std::string_view host);

}  // namespace kinemap
