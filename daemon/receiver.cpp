// SPDX-License-Identifier: Apache-2.0
#include "daemon/receiver.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <utility>

#include "daemon/suit_sockets.hpp"

namespace kinemap {
namespace {

/// The configuration has been checked: each text is one.
std::vector<Network> networks(const std::vector<std::string>& texts) {
  std::vector<Network> list;
  for (const auto& text : texts)
    if (const auto network = Network::parse(text)) list.push_back(*network);
  return list;
}

/// Makes `socket` the kept one, if there is one and it is bound to where it is wanted; else that one is closed.
bool take_over(net::ip::udp::socket& socket, const net::ip::udp::endpoint& wanted, int kept) {
  ErrorCode error;
  if (kept < 0) return false;
  if (socket.assign(wanted.protocol(), kept, error)) {
    ::close(kept);
    return false;
  }
  if (socket.local_endpoint(error) == wanted) {
    spdlog::info("suit: goes on with the socket of the daemon before, and what came to it meanwhile");
    return true;
  }
  socket.close(error);
  return false;
}

}  // namespace

class Receiver::Impl {
 public:
  Impl(const AssemblerConfig& stream, SuitSink sink) : intake_(stream, std::move(sink)) {}
  ~Impl() { io_.stop(); }

  /// Binds and starts to listen; the thread begins with `run`.
  ErrorCode bind_udp(const net::ip::address& address, const Config::Suit& suit, int kept) {
    net::ip::udp::socket socket(io_);
    const net::ip::udp::endpoint endpoint(address, suit.port);
    ErrorCode error;
    if (!take_over(socket, endpoint, kept)) {
      socket.open(endpoint.protocol(), error);
      if (!error) socket.bind(endpoint, error);
      if (error) return error;
    }
    set_receive_buffer(socket, suit.receive_buffer_bytes);
    port_ = socket.local_endpoint().port();
    udp_socket_ = socket.native_handle();
    udp_ = std::make_unique<UdpSource>(std::move(socket), intake_, networks(suit.allow));
    udp_->start();
    return {};
  }

  ErrorCode bind_tcp(const net::ip::address& address, const Config::Suit& suit) {
    net::ip::tcp::acceptor acceptor(io_);
    const net::ip::tcp::endpoint endpoint(address, suit.port);
    ErrorCode error;
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
    if (error) return error;
    port_ = acceptor.local_endpoint().port();
    tcp_ = std::make_unique<TcpSource>(std::move(acceptor), intake_, networks(suit.allow));
    tcp_->start();
    return {};
  }

  void run() {
    watch_silence();
    thread_ = std::jthread([this] { io_.run(); });
    pthread_setname_np(thread_.native_handle(), "suit");
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int udp_socket() const { return udp_socket_; }
  [[nodiscard]] ReceiverState state() const { return intake_.state(); }

 private:
  void watch_silence() {
    silence_.expires_after(std::chrono::milliseconds(500));
    silence_.async_wait([this](ErrorCode error) {
      if (error) return;
      intake_.check_silence();
      watch_silence();
    });
  }

  net::io_context io_{1};
  net::steady_timer silence_{io_};  // the thread only
  Intake intake_;                   // the thread takes, everyone may ask for its state
  std::unique_ptr<UdpSource> udp_;  // the thread only
  std::unique_ptr<TcpSource> tcp_;  // the thread only
  std::uint16_t port_ = 0;
  int udp_socket_ = -1;
  std::jthread thread_;  // last: joined first
};

Started<Receiver> Receiver::open(const Config::Suit& suit, const AssemblerConfig& stream, SuitSink sink, int kept) {
  const bool tcp = suit.transport == "tcp";
  const Binding binding{tcp ? "TCP" : "UDP", suit.address, suit.port, "suit.port", "--suit-port"};
  ErrorCode error;
  const auto address = net::ip::make_address(suit.address, error);
  auto impl = std::make_unique<Impl>(stream, std::move(sink));
  if (tcp && kept >= 0) ::close(kept);
  if (!error) error = tcp ? impl->bind_tcp(address, suit) : impl->bind_udp(address, suit, kept);
  if (error) return bind_error(binding, error);
  impl->run();
  return std::unique_ptr<Receiver>(new Receiver(std::move(impl)));
}

Receiver::Receiver(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Receiver::~Receiver() = default;

std::uint16_t Receiver::port() const { return impl_->port(); }
int Receiver::udp_socket() const { return impl_->udp_socket(); }
ReceiverState Receiver::state() const { return impl_->state(); }

}  // namespace kinemap
