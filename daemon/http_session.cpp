// SPDX-License-Identifier: Apache-2.0
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <optional>

#include "daemon/foxglove_protocol.hpp"
#include "daemon/web.hpp"

namespace kinemap {
namespace {

constexpr std::uint32_t kHeaderLimit = 8192;
constexpr std::uint64_t kBodyLimit = 16384;  // no request needs a body; what comes is read and ignored
constexpr std::size_t kTargetLimit = 2048;
constexpr std::string_view kStreamPath = "/api/v1/stream", kFoxglovePath = "/";
constexpr std::chrono::seconds kReadTimeout{30}, kWriteTimeout{60};

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

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
      : stream_(std::move(socket)), context_(context), slot_(std::move(slot)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kHeaderLimit);
    parser_->body_limit(kBodyLimit);
    stream_.expires_after(kReadTimeout);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_read(error); });
  }

 private:
  void on_read(ErrorCode error) {
    if (error) {
      const auto problem = read_error(error);
      if (!problem) return close();
      keep_alive_ = false;
      return send(context_.api.refuse(*problem));
    }
    const auto& request = parser_->get();
    keep_alive_ = request.keep_alive();
    head_ = request.method() == http::verb::head;
    if (const auto problem = refusal(request)) {
      return send(context_.api.refuse(*problem));
    }
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

  /// What is wrong with a request before its path is looked at.
  std::optional<ApiError> refusal(const http::request<http::string_body>& request) {
    const auto host = view(request[http::field::host]);
    if (context_.api.counts().connections > context_.max_clients) {
      keep_alive_ = false;
      ++context_.api.counts().refused;
      return ApiError{503, "too_many_clients",
                      "api.max_clients (" + std::to_string(context_.max_clients) + ") connections are open"};
    }
    if (!host_allowed(host, context_.loopback_only))
      return ApiError{403, "forbidden_host",
                      "this server answers to localhost only; api.address in the configuration opens it"};
    if (request.target().size() > kTargetLimit)
      return ApiError{414, "target_too_long", "the request's target is longer than 2 KiB"};
    if (!beast::websocket::is_upgrade(request)) return std::nullopt;
    return upgrade_refusal(request, host);
  }

  static std::string_view path_of(const http::request<http::string_body>& request) {
    const auto target = view(request.target());
    return target.substr(0, target.find('?'));
  }

  static std::optional<ApiError> upgrade_refusal(const http::request<http::string_body>& request,
                                                 std::string_view host) {
    const auto path = path_of(request);
    const auto origin = view(request[http::field::origin]);
    if (path != kStreamPath && path != kFoxglovePath)
      return ApiError{.status = 404,
                      .code = "not_found",
                      .message = "the WebSocket is at /api/v1/stream, the one for Foxglove's viewers at /",
                      .nearest = std::string(kStreamPath)};
    if (!(path == kStreamPath ? origin_allowed(origin, host) : viewer_origin_allowed(origin, host)))
      return ApiError{403, "forbidden_origin", "pages of other hosts may not open the stream"};
    if (path == kFoxglovePath && !foxglove::choose_subprotocol(view(request[http::field::sec_websocket_protocol])))
      return ApiError{400, "bad_subprotocol",
                      "at / the WebSocket subprotocol is foxglove.sdk.v1 or foxglove.websocket.v1; Kinemap's own "
                      "stream is at /api/v1/stream"};
    return std::nullopt;
  }

  void upgrade() {
    stream_.expires_never();  // the WebSocket has its own time-outs
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
    stream_.expires_after(kWriteTimeout);
    http::async_write(stream_, *response, [self = shared_from_this(), response](ErrorCode error, std::size_t) {
      if (error || !self->keep_alive_) return self->close();
      self->read();
    });
  }

  /// Says goodbye, then reads off what the peer still sends, so that its last answer is not lost to a reset.
  void close() {
    ErrorCode ignored;
    stream_.socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
    stream_.expires_after(std::chrono::seconds(2));
    drain(16);
  }
  void drain(int reads) {
    if (reads == 0) return;
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(4096), [self = shared_from_this(), reads](ErrorCode error, std::size_t) {
      if (!error) self->drain(reads - 1);
    });
  }

  beast::tcp_stream stream_;
  WebContext& context_;
  ConnectionSlot slot_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpAnswer answer_;  // owns the text while it is being sent
  bool keep_alive_ = false;
  bool head_ = false;
};

}  // namespace

void serve_http(net::ip::tcp::socket socket, WebContext& context, ConnectionSlot slot) {
  std::make_shared<HttpSession>(std::move(socket), context, std::move(slot))->read();
}

}  // namespace kinemap
