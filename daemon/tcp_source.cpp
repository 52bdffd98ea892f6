// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include "daemon/suit_sockets.hpp"

namespace kinemap {
namespace {

constexpr std::uint64_t kMaxConnections = 8;

std::string name_of(const net::ip::tcp::socket& socket) {
  ErrorCode error;
  const auto endpoint = socket.remote_endpoint(error);
  if (error) return "a peer that is gone";
  const std::string address = endpoint.address().to_string();
  return (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" + std::to_string(endpoint.port());
}

}  // namespace

struct TcpSource::Connection {
  net::ip::tcp::socket socket;
  std::string sender;
  StreamFramer framer;
  std::array<std::byte, 65536> buffer{};
};

TcpSource::TcpSource(net::ip::tcp::acceptor acceptor, Intake& intake, std::vector<Network> allowed)
    : acceptor_(std::move(acceptor)), intake_(intake), allowed_(std::move(allowed)) {}

void TcpSource::start() {
  acceptor_.async_accept([this](ErrorCode error, net::ip::tcp::socket socket) {
    if (error == net::error::operation_aborted) return;
    if (!error) welcome(std::move(socket));
    intake_.publish();
    start();
  });
}

/// Who is not welcome is disconnected.
void TcpSource::welcome(net::ip::tcp::socket socket) {
  auto& counts = intake_.counts();
  ErrorCode error;
  const auto peer = parse_address(socket.remote_endpoint(error).address().to_string());
  if (error || !allows(allowed_, *peer)) {
    ++counts.not_allowed;
    return;
  }
  if (counts.tcp_open >= kMaxConnections) {
    ++counts.tcp_refused;
    spdlog::warn("suit: {} connections are open, {} is refused", counts.tcp_open, name_of(socket));
    return;
  }
  ++counts.tcp_accepted;
  ++counts.tcp_open;
  auto connection = std::make_shared<Connection>(Connection{std::move(socket), {}, {}, {}});
  connection->sender = name_of(connection->socket);
  spdlog::info("suit: {} has connected", connection->sender);
  read(connection);
}

void TcpSource::read(const std::shared_ptr<Connection>& connection) {
  connection->socket.async_read_some(net::buffer(connection->buffer),
                                     [this, connection](ErrorCode error, std::size_t bytes) {
                                       if (error == net::error::operation_aborted) return;
                                       if (error) return close(*connection, error.message());
                                       take(*connection, bytes);
                                       if (connection->socket.is_open()) read(connection);
                                     });
}

void TcpSource::take(Connection& connection, std::size_t bytes) {
  const auto skipped = connection.framer.skipped_bytes();
  const bool speaks =
      connection.framer.add(std::span<const std::byte>(connection.buffer).first(bytes),
                            [&](std::span<const std::byte> datagram) { intake_.take(datagram, connection.sender); });
  intake_.counts().tcp_skipped_bytes += connection.framer.skipped_bytes() - skipped;
  if (!speaks) {
    ++intake_.counts().tcp_closed_garbage;
    close(connection, "64 KiB without one MXTP datagram");
  }
  intake_.publish();
}

void TcpSource::close(Connection& connection, const std::string& why) {
  spdlog::info("suit: the connection of {} ends: {}", connection.sender, why);
  ErrorCode ignored;
  connection.socket.close(ignored);
  --intake_.counts().tcp_open;
  intake_.publish();
}

}  // namespace kinemap
