// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/web.hpp"
// after Asio with its <utility>
#include <boost/beast/websocket.hpp>

namespace kinemap {

/// A message to one client.
struct Outgoing {
  std::string head;  ///< of this client's own, before the text; may be empty
  SharedText text;   ///< null: there is no message
  bool binary = false;

  [[nodiscard]] std::size_t size() const { return head.size() + (text ? text->size() : 0); }
};

/// One WebSocket connection, whatever is spoken on it: the handshake, reading, writing one message after the other, and
/// giving up on a client that does not take them. The server's thread only.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(NetStream stream, WebContext& context, ConnectionSlot slot);
  virtual ~WebSocketSession() = default;
  WebSocketSession(const WebSocketSession&) = delete;
  WebSocketSession& operator=(const WebSocketSession&) = delete;

  /// Answers the upgrade; `subprotocol` is the one chosen of those that the client offers, if it offers any.
  void accept(http::request<http::string_body> request, const std::string& subprotocol = {});

 protected:
  using Clock = std::chrono::steady_clock;

  /// The handshake is done.
  virtual void on_open() = 0;
  virtual void on_message(std::string_view message, bool text) = 0;
  /// The connection has ended; it is not called for one that was never open.
  virtual void on_end() {}
  /// The next message to send.
  virtual Outgoing next() = 0;

  /// Sends what next() has; to be called whenever there may be something.
  void write();
  /// Gives up when the client has not taken the message that is being sent in time.
  void check_stall(Clock::time_point now);
  /// The client is too slow: it is told why and disconnected.
  void give_up(const std::string& reason);
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] WebContext& context() const { return context_; }

 private:
  void read();
  void take();
  void end();
  /// Ends it, telling the client why. The closing frame cannot overtake the message that is being sent; when that one
  /// is not taken in time either, the connection is just ended.
  void close(int code, const std::string& reason);
  void leave(const ApiError& why);
  void cut_off();
  void say_goodbye();

  beast::websocket::stream<NetStream> stream_;
  net::steady_timer pause_;
  WebContext& context_;
  ConnectionSlot slot_;
  http::request<http::string_body> request_;
  beast::flat_buffer buffer_;
  std::optional<beast::websocket::close_reason> goodbye_;  // to be told
  bool open_ = false;                                      // the handshake is done
  bool writing_ = false;
  bool ended_ = false;
  Clock::time_point write_deadline_;  // of the message that is being sent
  Clock::time_point leave_deadline_ = Clock::time_point::max();
};

}  // namespace kinemap
