// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/client.hpp"

#include "daemon/net_stream.hpp"
// after Asio with its <utility>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cctype>
#include <nlohmann/json.hpp>

#include "daemon/network.hpp"
#include "protocol/text_format.hpp"
#include "tools/kinemap/certificate.hpp"

namespace kinemap::cli {
namespace {

namespace asio = boost::asio;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr auto kPatience = std::chrono::seconds(5);
constexpr std::size_t kMaxMessageBytes = std::size_t{256} << 20;  // a large building's map, with room to spare

Error connection_error(const DaemonAddress& daemon, const error_code& code) {
  std::string text = daemon.text() + ": " + code.message();
  if (code == asio::error::connection_refused)
    text += "; is kinemapd running there, with api.port " + std::to_string(daemon.endpoint.port) +
            " and, for other machines, an api.address that is not 127.0.0.1? --url or KINEMAP_URL names another";
  if (code.category() == asio::error::get_netdb_category()) text += "; check the name in --url or KINEMAP_URL";
  if (code == beast::error::timeout)
    text = daemon.text() + ": no answer within 5 s; is the machine on, and does its firewall let port " +
           std::to_string(daemon.endpoint.port) + " through?";
  return {text};
}

/// "Authorization: Bearer …" where there is a token.
template <class Request>
void show_token(const DaemonAddress& daemon, Request& request) {
  if (!daemon.token.empty()) request.set(http::field::authorization, "Bearer " + daemon.token);
}

/// Runs `io` until what was started on it has ended, and hands out how it ended.
error_code wait(asio::io_context& io, const error_code& code) {
  io.restart();
  io.run();
  return code;
}

/// Whose certificate is right: the pinned one, or one for this host that is vouched for.
Result<std::shared_ptr<ssl::context>> client_tls(const DaemonAddress& daemon) {
  auto context = std::make_shared<ssl::context>(ssl::context::tls_client);
  SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
  if (!daemon.fingerprint.empty()) return context;  // looked at after the handshake, before anything is sent
  error_code code;
  if (daemon.ca.empty())
    context->set_default_verify_paths(code);
  else
    context->load_verify_file(daemon.ca, code);
  if (code) return Error{daemon.ca + ": cannot be used as certificates (PEM): " + code.message()};
  context->set_verify_mode(ssl::verify_peer);
  context->set_verify_callback(ssl::host_name_verification(daemon.endpoint.host));
  return context;
}

/// The TLS handshake on a connected stream.
std::optional<Error> encrypt(asio::io_context& io, NetStream& stream, const DaemonAddress& daemon) {
  auto context = client_tls(daemon);
  if (!context) return Error{context.error()};
  stream.encrypt(*std::move(context));
  SSL* const native = stream.tls().native_handle();
  if (!parse_address(daemon.endpoint.host)) SSL_set_tlsext_host_name(native, daemon.endpoint.host.c_str());
  error_code code;
  stream.tls().async_handshake(ssl::stream_base::client, [&](const error_code& result) { code = result; });
  if (wait(io, code)) {
    Error error = connection_error(daemon, code);
    if (SSL_get_verify_result(native) != X509_V_OK)
      error.message +=
          "; a certificate that `kinemap pair` made is known by its --fingerprint (or KINEMAP_FINGERPRINT)";
    return error;
  }
  if (daemon.fingerprint.empty()) return std::nullopt;
  const std::unique_ptr<X509, void (*)(X509*)> peer(SSL_get1_peer_certificate(native), X509_free);
  const std::string shown = peer ? fingerprint_of(peer.get()) : "";
  if (shown == daemon.fingerprint) return std::nullopt;
  return Error{daemon.text() + ": its certificate is another one (SHA-256 " + shown + ") than " + daemon.fingerprint +
               ": is this the right machine, or was it paired anew?"};
}

std::optional<Error> connect_stream(asio::io_context& io, NetStream& stream, const DaemonAddress& daemon) {
  error_code code;
  tcp::resolver resolver(io);
  const auto addresses = resolver.resolve(daemon.endpoint.host, std::to_string(daemon.endpoint.port), code);
  if (code) return connection_error(daemon, code);
  stream.next_layer().expires_after(kPatience);
  stream.next_layer().async_connect(addresses, [&](const error_code& result, const tcp::endpoint&) { code = result; });
  if (wait(io, code)) return connection_error(daemon, code);
  return daemon.tls ? encrypt(io, stream, daemon) : std::nullopt;
}

/// The daemon's own words for a status that is not 200: {"error": {"message": …}}.
std::string message_of(const http::response<http::string_body>& response) {
  const auto json = nlohmann::json::parse(response.body(), nullptr, false);
  const nlohmann::json::json_pointer message("/error/message");
  if (json.is_object() && json.contains(message) && json[message].is_string()) return json[message].get<std::string>();
  return std::to_string(response.result_int()) + " " + std::string(response.reason());
}

}  // namespace

Result<std::string> http_get(const DaemonAddress& daemon, const std::string& target) {
  asio::io_context io;
  NetStream stream(io);
  if (auto error = connect_stream(io, stream, daemon)) return std::move(*error);
  error_code code;

  http::request<http::empty_body> request(http::verb::get, daemon.path + target, 11);
  request.set(http::field::host, daemon.endpoint.text());
  show_token(daemon, request);
  request.set(http::field::user_agent, "kinemap");
  request.set(http::field::connection, "close");
  stream.next_layer().expires_after(kPatience);
  http::async_write(stream, request, [&](const error_code& result, std::size_t) { code = result; });
  if (wait(io, code)) return connection_error(daemon, code);

  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(kMaxMessageBytes);
  stream.next_layer().expires_after(kPatience);
  http::async_read(stream, buffer, parser, [&](const error_code& result, std::size_t) { code = result; });
  if (wait(io, code)) {
    Error error = connection_error(daemon, code);
    if (code.category() == http::make_error_code(http::error::end_of_stream).category())
      error.message += "; is this the API port of kinemapd?";
    return error;
  }
  http::response<http::string_body> response = parser.release();
  if (response.result() == http::status::unauthorized)
    return Error{
        daemon.text() + ": " + message_of(response) +
        (daemon.token.empty() ? "; put its token into KINEMAP_TOKEN" : "; KINEMAP_TOKEN is not the right one")};
  if (response.result() != http::status::ok) return Error{daemon.text() + target + ": " + message_of(response)};
  return std::move(response.body());
}

std::string url_encoded(const std::string& text) {
  constexpr std::string_view kPlain = "-._~,";  // the comma may stand in a query, and reads better
  std::string encoded;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) || kPlain.find(c) != std::string_view::npos)
      encoded += c;
    else
      encoded += format("%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return encoded;
}

class StreamClient::Impl {
 public:
  explicit Impl(DaemonAddress daemon) : daemon_(std::move(daemon)), socket_(io_) {}

  ~Impl() {
    if (!reading_) return;
    // A read is under way: end it before what it refers to goes.
    beast::get_lowest_layer(socket_).close();
    io_.restart();
    io_.run();
  }

  std::optional<Error> open(const std::string& subscribe) {
    if (auto error = connect_stream(io_, socket_.next_layer(), daemon_)) return error;
    error_code code;
    beast::get_lowest_layer(socket_).expires_never();
    auto timeouts = websocket::stream_base::timeout::suggested(beast::role_type::client);
    timeouts.handshake_timeout = kPatience;
    timeouts.idle_timeout = std::chrono::seconds(30);
    timeouts.keep_alive_pings = true;
    socket_.set_option(timeouts);
    socket_.read_message_max(kMaxMessageBytes);
    socket_.set_option(
        websocket::stream_base::decorator([this](websocket::request_type& request) { show_token(daemon_, request); }));
    socket_.async_handshake(daemon_.endpoint.text(), daemon_.path + "/api/v1/stream",
                            [&](const error_code& result) { code = result; });
    if (wait(io_, code)) return connection_error(daemon_, code);
    socket_.async_write(asio::buffer(subscribe), [&](const error_code& result, std::size_t) { code = result; });
    if (wait(io_, code)) return connection_error(daemon_, code);
    return std::nullopt;
  }

  Result<std::optional<std::string>> next(std::chrono::milliseconds timeout) {
    if (!reading_) {
      reading_ = true;
      done_ = false;
      socket_.async_read(buffer_, [this](const error_code& result, std::size_t) {
        result_ = result;
        done_ = true;
      });
    }
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    io_.restart();
    // Pings and timers are handlers as well: go on until the read itself has ended.
    while (!done_ && std::chrono::steady_clock::now() < deadline) io_.run_one_until(deadline);
    if (!done_) return std::optional<std::string>{};
    reading_ = false;
    if (result_) return connection_error(daemon_, result_);
    std::string message = beast::buffers_to_string(buffer_.data());
    buffer_.clear();
    return std::optional<std::string>{std::move(message)};
  }

 private:
  DaemonAddress daemon_;
  asio::io_context io_;
  websocket::stream<NetStream> socket_;
  beast::flat_buffer buffer_;
  error_code result_;
  bool reading_ = false;
  bool done_ = false;
};

Result<StreamClient> StreamClient::connect(const DaemonAddress& daemon, const std::string& subscribe) {
  auto impl = std::make_unique<Impl>(daemon);
  if (auto error = impl->open(subscribe)) return *error;
  return StreamClient(std::move(impl));
}

StreamClient::StreamClient(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StreamClient::~StreamClient() = default;
StreamClient::StreamClient(StreamClient&&) noexcept = default;
StreamClient& StreamClient::operator=(StreamClient&&) noexcept = default;

Result<std::optional<std::string>> StreamClient::next(std::chrono::milliseconds timeout) {
  return impl_->next(timeout);
}

}  // namespace kinemap::cli
