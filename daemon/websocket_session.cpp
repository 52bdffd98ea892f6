// SPDX-License-Identifier: Apache-2.0
#include "daemon/websocket_session.hpp"

#include <array>
#include <utility>

namespace kinemap {
namespace {

namespace websocket = beast::websocket;

constexpr std::size_t kLongestMessage = 256 * 1024;  // from a client
constexpr std::size_t kSlowestBytesPerS = 64 * 1024;
constexpr std::chrono::seconds kIdleTimeout{30};
constexpr std::chrono::seconds kLeaveTimeout{3};  // for a client whose place is needed

}  // namespace

WebSocketSession::WebSocketSession(NetStream stream, WebContext& context, ConnectionSlot slot)
    : stream_(std::move(stream)), pause_(stream_.get_executor()), context_(context), slot_(std::move(slot)) {
  slot_.guest().stream = true;
  slot_.guest().leave = [this](const ApiError& why) { leave(why); };
}

void WebSocketSession::accept(http::request<http::string_body> request, const std::string& subprotocol) {
  auto timeouts = websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeouts.idle_timeout = kIdleTimeout;
  timeouts.keep_alive_pings = true;
  stream_.set_option(timeouts);
  stream_.set_option(websocket::permessage_deflate{});  // off
  stream_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
    response.set(http::field::server, "kinemapd");
    if (!subprotocol.empty()) response.set(http::field::sec_websocket_protocol, subprotocol);
  }));
  stream_.read_message_max(kLongestMessage);
  request_ = std::move(request);
  stream_.async_accept(request_, [self = shared_from_this()](ErrorCode error) {
    if (error) return;
    self->open_ = true;
    ++self->context_.api.counts().streams;
    self->on_open();
    self->write();
    self->read();
  });
}

void WebSocketSession::read() {
  stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
    if (error) return self->end();
    self->take();
  });
}

/// A message is a request like any other; who sends too many is read more slowly.
void WebSocketSession::take() {
  if (ended_) return;
  const auto pause = context_.limited(slot_.visitor()) ? context_.visitors.ask(slot_.visitor(), Clock::now())
                                                       : Clock::duration::zero();
  if (pause > Clock::duration::zero()) {
    pause_.expires_after(pause);
    return pause_.async_wait([self = shared_from_this()](ErrorCode error) {
      if (!error) self->take();
    });
  }
  const auto data = buffer_.data();
  on_message({static_cast<const char*>(data.data()), data.size()}, stream_.got_text());
  buffer_.consume(buffer_.size());
  write();
  if (!ended_) read();
}

void WebSocketSession::write() {
  if (writing_ || ended_) return;
  auto message = std::make_shared<const Outgoing>(next());
  if (!message->text) return;
  writing_ = true;
  write_deadline_ = Clock::now() + context_.limits.stall + std::chrono::seconds(message->size() / kSlowestBytesPerS);
  stream_.binary(message->binary);
  const std::array<net::const_buffer, 2> buffers{net::buffer(message->head), net::buffer(*message->text)};
  stream_.async_write(buffers, [self = shared_from_this(), message](ErrorCode error, std::size_t) {
    self->writing_ = false;
    if (error) return self->end();
    if (self->ended_) return self->say_goodbye();
    self->write();
  });
}

void WebSocketSession::check_stall(Clock::time_point now) {
  if (now > leave_deadline_) return cut_off();
  if (!writing_ || now <= write_deadline_) return;
  give_up("slow reader");
  cut_off();
}

void WebSocketSession::give_up(const std::string& reason) {
  if (ended_) return;
  ++context_.api.counts().slow_clients_closed;
  close(websocket::close_code::policy_error, reason);
}

void WebSocketSession::close(int code, const std::string& reason) {
  if (ended_) return;
  constexpr std::size_t kLongestReason = 123;  // of a closing frame, RFC 6455
  goodbye_ = websocket::close_reason(static_cast<websocket::close_code>(code), reason.substr(0, kLongestReason));
  end();
  if (!writing_) say_goodbye();
}

/// Codes of our own tell what HTTP says with the status.
void WebSocketSession::leave(const ApiError& why) {
  leave_deadline_ = Clock::now() + kLeaveTimeout;
  const int code = why.status == 503 ? int{websocket::close_code::try_again_later} : 4000 + why.status;
  if (!open_) return cut_off();
  close(code, why.code + ": " + why.message);
}

void WebSocketSession::cut_off() {
  ErrorCode ignored;
  beast::get_lowest_layer(stream_).socket().close(ignored);
}

void WebSocketSession::say_goodbye() {
  if (!goodbye_) return;
  stream_.async_close(*std::exchange(goodbye_, std::nullopt), [self = shared_from_this()](ErrorCode) {});
}

void WebSocketSession::end() {
  if (std::exchange(ended_, true)) return;
  --context_.api.counts().streams;
  on_end();
}

}  // namespace kinemap
