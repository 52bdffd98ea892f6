// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/client.hpp"

#include "daemon/web.hpp"
// after Asio
#include <sys/socket.h>
#include <unistd.h>

#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace kinemap::test {
namespace {

namespace websocket = beast::websocket;
using nlohmann::json;

net::ip::tcp::endpoint local(std::uint16_t port) { return {net::ip::address_v4::loopback(), port}; }

/// A server that hangs must fail a test, not hold it for ever.
void limit_waiting(net::ip::tcp::socket& socket) {
  const timeval limit{60, 0};
  ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

}  // namespace

std::string HttpReply::header(std::string_view name) const {
  for (const auto& [key, value] : headers)
    if (beast::iequals({key.data(), key.size()}, {name.data(), name.size()})) return value;
  return {};
}

json HttpReply::json() const { return nlohmann::json::parse(body, nullptr, false); }

std::string raw_exchange(std::uint16_t port, std::string_view bytes) {
  net::io_context io;
  net::ip::tcp::socket socket(io);
  ErrorCode error;
  socket.connect(local(port), error);
  limit_waiting(socket);
  if (!error) net::write(socket, net::buffer(bytes.data(), bytes.size()), error);
  socket.shutdown(net::ip::tcp::socket::shutdown_send, error);
  std::string answer;
  net::read(socket, net::dynamic_buffer(answer), error);
  return answer;
}

class HttpClient::Impl {
 public:
  explicit Impl(std::uint16_t port) {
    ErrorCode error;
    socket.connect(local(port), error);
    limit_waiting(socket);
    host = "localhost:" + std::to_string(port);
  }
  net::io_context io;
  net::ip::tcp::socket socket{io};
  beast::flat_buffer buffer;
  std::string host;
};

HttpClient::HttpClient(std::uint16_t port) : impl_(std::make_unique<Impl>(port)) {}
HttpClient::~HttpClient() = default;

HttpReply HttpClient::request(const std::string& method, const std::string& target,
                              const std::vector<std::pair<std::string, std::string>>& headers,
                              const std::string& body) {
  http::request<http::string_body> request;
  request.version(11);
  request.method_string(method);
  request.target(target);
  request.set(http::field::host, impl_->host);
  for (const auto& [name, value] : headers) request.set(name, value);
  request.body() = body;
  request.prepare_payload();
  ErrorCode error;
  http::write(impl_->socket, request, error);  // the server may answer before it has read all
  http::response_parser<http::string_body> parser;
  parser.body_limit(1 << 28);
  parser.skip(method == "HEAD");
  http::read(impl_->socket, impl_->buffer, parser, error);
  if (error) return {};
  HttpReply reply{static_cast<int>(parser.get().result_int()), parser.get().body(), {}};
  for (const auto& field : parser.get())
    reply.headers.emplace_back(std::string(field.name_string()), std::string(field.value()));
  return reply;
}

class StreamClient::Impl {
 public:
  net::io_context io;
  websocket::stream<net::ip::tcp::socket> stream{io};
};

StreamClient::StreamClient(std::uint16_t port, int receive_buffer) : impl_(std::make_unique<Impl>()) {
  auto& socket = impl_->stream.next_layer();
  socket.open(net::ip::tcp::v4());
  if (receive_buffer > 0) socket.set_option(net::socket_base::receive_buffer_size(receive_buffer));
  socket.connect(local(port));
  limit_waiting(socket);
  impl_->stream.read_message_max(0);
  impl_->stream.handshake("localhost:" + std::to_string(port), "/api/v1/stream");
}
StreamClient::~StreamClient() = default;

void StreamClient::send(const std::string& text, bool binary) {
  impl_->stream.binary(binary);
  impl_->stream.write(net::buffer(text));
}

bool StreamClient::try_send(const std::string& text) {
  ErrorCode error;
  impl_->stream.binary(false);
  impl_->stream.write(net::buffer(text), error);
  return !error;
}

json StreamClient::receive() {
  beast::flat_buffer buffer;
  ErrorCode error;
  impl_->stream.read(buffer, error);
  if (error)
    return {{"closed", impl_->stream.reason().code},
            {"reason", std::string(impl_->stream.reason().reason.c_str())},
            {"why", error.message()}};
  return json::parse(beast::buffers_to_string(buffer.data()));
}

json StreamClient::receive(const json& wanted) {
  for (;;) {
    json message = receive();
    bool matches = true;
    for (const auto& [key, value] : wanted.items()) matches = matches && message.contains(key) && message[key] == value;
    if (matches || message.contains("closed")) return message;
  }
}

UdpSender::UdpSender(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
  const auto endpoint = net::ip::udp::endpoint(net::ip::address_v4::loopback(), port);
  if (::connect(socket_, endpoint.data(), static_cast<socklen_t>(endpoint.size())) != 0)
    throw std::runtime_error("no UDP socket");
}
UdpSender::~UdpSender() { ::close(socket_); }
void UdpSender::send(std::span<const std::byte> bytes) { (void)!::send(socket_, bytes.data(), bytes.size(), 0); }

void send_udp(std::uint16_t port, std::span<const std::byte> bytes) { UdpSender(port).send(bytes); }

}  // namespace kinemap::test
