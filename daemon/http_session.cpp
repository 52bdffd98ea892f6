// SPDX-License-Identifier: Apache-2.0
#include <boost/beast/core/detect_ssl.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <optional>
#include <utility>

#include "daemon/admission.hpp"
#include "daemon/foxglove_protocol.hpp"

namespace kinemap {
namespace {

constexpr std::uint32_t kHeaderLimit = 8192;
constexpr std::uint64_t kBodyLimit = 16384;  // no request needs a body; what comes is read and ignored
constexpr std::chrono::seconds kReadTimeout{30}, kWriteTimeout{60};  // of a connection that was used

/// Why a request could not be read; nullopt when nobody is there to be told.
std::optional<ApiError> read_error(ErrorCode error) {
  if (error == http::error::header_limit)
    return ApiError{431, "header_too_large", "the request's header is longer than 8 KiB"};
  if (error == http::error::body_limit) return ApiError{413, "body_too_large", "requests need no body"};
  if (error == http::error::end_of_stream || error == http::error::partial_message) return std::nullopt;
  if (error.category() == http::make_error_code(http::error::bad_method).category())
    return ApiError{400, "bad_request", "not an HTTP request: " + error.message()};
  return std::nullopt;
}

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(net::ip::tcp::socket socket, WebContext& context, ConnectionSlot slot)
      : stream_(std::move(socket)), context_(context), slot_(std::move(slot)) {
    slot_.guest().leave = [this](const ApiError&) { stream_.next_layer().close(); };
  }

  /// The first byte tells TLS from HTTP, which this machine's programs may speak on the same port.
  void start() {
    stream_.next_layer().expires_after(context_.limits.request);
    if (!context_.security.tls) return read();
    beast::async_detect_ssl(stream_.next_layer(), buffer_, [self = shared_from_this()](ErrorCode error, bool is_tls) {
      if (error) return self->give_up(error);
      if (!is_tls) return self->read();
      self->shake_hands();
    });
  }

 private:
  void shake_hands() {
    stream_.encrypt(context_.security.tls);
    const auto begun = [self = shared_from_this()](ErrorCode error, std::size_t used) {
      if (error && error != beast::error::timeout) ++self->context_.api.counts().handshakes_failed;
      if (error) return self->give_up(error);
      self->buffer_.consume(used);
      self->read();
    };
    stream_.tls().async_handshake(ssl::stream_base::server, buffer_.data(), begun);
  }

  /// Reads a request, within the time that runs already.
  void read() {
    parser_.emplace();
    parser_->header_limit(kHeaderLimit);
    parser_->body_limit(kBodyLimit);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_read(error); });
  }

  void read_next() {
    slot_.mark(true);
    stream_.next_layer().expires_after(kReadTimeout);
    first_ = false;
    read();
  }

  /// Nobody is there to be told.
  void give_up(ErrorCode error) {
    const bool begun = first_ || (parser_ && parser_->got_some());
    if (error == beast::error::timeout && begun) ++context_.api.counts().slow_requests_closed;
  }

  void on_read(ErrorCode error) {
    slot_.mark(false);
    if (error) {
      const auto problem = read_error(error);
      if (!problem) {
        give_up(error);
        return close();
      }
      keep_alive_ = false;
      return send(context_.api.refuse(*problem));
    }
    const auto& request = parser_->get();
    keep_alive_ = request.keep_alive();
    head_ = request.method() == http::verb::head;
    const auto problem = refusal(request, slot_.guest(), stream_.encrypted(), context_);
    keep_alive_ = keep_alive_ && !slot_.guest().surplus;
    if (problem) return send(context_.api.refuse(*problem));
    if (beast::websocket::is_upgrade(request)) return upgrade();
    answer();
  }

  [[nodiscard]] HttpRequest request() const {
    const auto& request = parser_->get();
    return {view(request.method_string()), view(request.target()), view(request[http::field::if_none_match]),
            view(request[http::field::accept_encoding])};
  }

  /// What takes long is made in the workshop, so that nobody else waits for it.
  void answer() {
    Reply reply = context_.api.begin(request());
    if (!reply.later) return send(context_.api.finish(std::move(reply), request()));
    net::post(context_.workshop, [self = shared_from_this(), reply = std::move(reply)]() mutable {
      reply = made(std::move(reply));
      const auto server = self->stream_.get_executor();
      // With all that it holds: the session ends on the server's thread.
      net::post(server, [self = std::move(self), reply = std::move(reply)]() mutable {
        self->send(self->context_.api.finish(std::move(reply), self->request()));
      });
    });
  }

  void upgrade() {
    stream_.next_layer().expires_never();  // the WebSocket has its own time-outs
    auto request = parser_->release();
    if (path_of(request) == kStreamPath)
      return serve_stream(std::move(stream_), std::move(request), context_, std::move(slot_));
    const auto subprotocol = foxglove::choose_subprotocol(view(request[http::field::sec_websocket_protocol]));
    serve_foxglove(std::move(stream_), std::move(request), *subprotocol, context_, std::move(slot_));
  }

  void send(HttpAnswer answer) {
    answer_ = std::move(answer);
    if (head_) return write<http::empty_body>();
    write<http::span_body<const char>>();
  }

  template <class Body>
  void write() {
    auto response = std::make_shared<http::response<Body>>();
    response->result(answer_.status);
    response->version(11);
    response->set(http::field::server, "kinemapd");
    for (const auto& [name, value] : answer_.headers) response->set(name, value);
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Content-Security-Policy",
                  "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response->keep_alive(keep_alive_);
    if (answer_.status != 304) response->content_length(answer_.body->size());
    if constexpr (!std::is_same_v<Body, http::empty_body>)
      response->body() = {answer_.body->data(), answer_.body->size()};
    stream_.next_layer().expires_after(kWriteTimeout);
    http::async_write(stream_, *response, [self = shared_from_this(), response](ErrorCode error, std::size_t) {
      if (error || !self->keep_alive_) return self->close();
      self->read_next();
    });
  }

  /// Says goodbye, then reads off what the peer still sends, so that its last answer is not lost to a reset.
  void close() {
    stream_.next_layer().expires_after(std::chrono::seconds(2));
    if (stream_.encrypted()) return stream_.tls().async_shutdown([self = shared_from_this()](ErrorCode) {});
    ErrorCode ignored;
    stream_.next_layer().socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
    drain(16);
  }
  void drain(int reads) {
    if (reads == 0) return;
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(4096), [self = shared_from_this(), reads](ErrorCode error, std::size_t) {
      if (!error) self->drain(reads - 1);
    });
  }

  NetStream stream_;
  WebContext& context_;
  ConnectionSlot slot_;
  bool first_ = true;  // no request has been answered yet
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpAnswer answer_;  // owns the text while it is being sent
  bool keep_alive_ = false;
  bool head_ = false;
};

}  // namespace

void serve_http(net::ip::tcp::socket socket, WebContext& context, ConnectionSlot slot) {
  std::make_shared<HttpSession>(std::move(socket), context, std::move(slot))->start();
}

}  // namespace kinemap
