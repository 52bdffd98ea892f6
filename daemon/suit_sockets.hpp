// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "daemon/asio.hpp"
#include "daemon/framer.hpp"
#include "daemon/intake.hpp"
#include "daemon/network.hpp"

namespace kinemap {

/// Reads datagrams of any number of senders from a bound UDP socket, on the socket's io_context.
class UdpSource {
 public:
  UdpSource(net::ip::udp::socket socket, Intake& intake, std::vector<Network> allowed);
  void start();

 private:
  void read_all();
  /// One datagram with recvmsg (Asio's own call hides the kernel's drop counter); false when none is waiting.
  bool read_one();
  void note_sender(const sockaddr_storage& sender, std::size_t length);

  net::ip::udp::socket socket_;
  Intake& intake_;
  std::vector<std::byte> buffer_;
  std::vector<Network> allowed_;
  sockaddr_storage last_sender_{};  // looked at only when it changes
  std::string last_name_;
  bool last_allowed_ = false;
};

/// Accepts MVN's TCP connections and reads datagrams from each.
class TcpSource {
 public:
  TcpSource(net::ip::tcp::acceptor acceptor, Intake& intake, std::vector<Network> allowed);
  void start();

 private:
  struct Connection;
  void read(const std::shared_ptr<Connection>& connection);
  void take(Connection& connection, std::size_t bytes);
  void close(Connection& connection, const std::string& why);

  void welcome(net::ip::tcp::socket socket);

  net::ip::tcp::acceptor acceptor_;
  Intake& intake_;
  std::vector<Network> allowed_;
};

/// Asks for a large receive buffer and says so when the kernel grants less.
void set_receive_buffer(net::ip::udp::socket& socket, int bytes);

}  // namespace kinemap
