// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "daemon/asio.hpp"
// after Asio with its <utility>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace kinemap {

namespace beast = boost::beast;
namespace ssl = net::ssl;

/// A TCP connection with Beast's time limits, in the clear until a TLS handshake begins: one type for both, so that
/// what is spoken on it is written once.
class NetStream {
 public:
  using executor_type = beast::tcp_stream::executor_type;
  using next_layer_type = beast::tcp_stream;

  explicit NetStream(net::ip::tcp::socket socket) : tcp_(std::in_place, std::move(socket)) {}
  explicit NetStream(net::io_context& io) : tcp_(std::in_place, io) {}

  [[nodiscard]] bool encrypted() const { return tls_.has_value(); }
  executor_type get_executor() noexcept { return next_layer().get_executor(); }
  beast::tcp_stream& next_layer() noexcept { return tls_ ? tls_->next_layer() : *tcp_; }
  const beast::tcp_stream& next_layer() const noexcept { return tls_ ? tls_->next_layer() : *tcp_; }

  /// From here on over TLS; the handshake is still to be done, on `tls()`.
  void encrypt(std::shared_ptr<ssl::context> context) {
    context_ = std::move(context);
    tls_.emplace(std::move(*tcp_), *context_);
    tcp_.reset();
  }
  beast::ssl_stream<beast::tcp_stream>& tls() { return *tls_; }

  template <class Buffers, class Handler>
  auto async_read_some(const Buffers& buffers, Handler&& handler) {
    return tls_ ? tls_->async_read_some(buffers, std::forward<Handler>(handler))
                : tcp_->async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  auto async_write_some(const Buffers& buffers, Handler&& handler) {
    return tls_ ? tls_->async_write_some(buffers, std::forward<Handler>(handler))
                : tcp_->async_write_some(buffers, std::forward<Handler>(handler));
  }

  /// How Beast ends a WebSocket's connection.
  template <class Handler>
  friend void async_teardown(beast::role_type role, NetStream& stream, Handler&& handler) {
    using beast::websocket::async_teardown;
    if (stream.tls_)
      async_teardown(role, *stream.tls_, std::forward<Handler>(handler));
    else
      async_teardown(role, *stream.tcp_, std::forward<Handler>(handler));
  }
  friend void teardown(beast::role_type role, NetStream& stream, ErrorCode& error) {
    using beast::websocket::teardown;
    if (stream.tls_)
      teardown(role, *stream.tls_, error);
    else
      teardown(role, *stream.tcp_, error);
  }

 private:
  std::shared_ptr<ssl::context> context_;  // of before the last reload, perhaps
  std::optional<beast::tcp_stream> tcp_;   // exactly one of the two is there
  std::optional<beast::ssl_stream<beast::tcp_stream>> tls_;
};

}  // namespace kinemap
