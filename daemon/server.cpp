// SPDX-License-Identifier: Apache-2.0
#include "daemon/server.hpp"

#include <netinet/tcp.h>
#include <pthread.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "daemon/foxglove_feed.hpp"
#include "daemon/web.hpp"

namespace kinemap {
namespace {

constexpr int kSendBufferBytes = 128 * 1024;      // what a stopped reader can hide in the kernel
constexpr unsigned kUserTimeoutMs = 20000;        // unacknowledged for so long: the peer is gone
constexpr std::chrono::milliseconds kPause{100};  // after a failed accept (no file descriptors left)

}  // namespace

class Server::Impl {
 public:
  Impl(const Config::Api& config, Security security, Sources sources, const Config::Suit& suit, std::uint16_t suit_port,
       const ServerLimits& limits)
      : api_(std::move(sources), suit, suit_port),
        hub_(api_, config.pose_rate_hz),
        foxglove_(api_),
        context_{api_,
                 hub_,
                 foxglove_,
                 workshop_,
                 std::move(security),
                 Visitors(config.max_requests_per_s),
                 config,
                 limits,
                 Guests(api_.counts())} {}
  ~Impl() { io_.stop(); }

  ErrorCode bind(const net::ip::address& address, std::uint16_t port) {
    const net::ip::tcp::endpoint endpoint(address, port);
    ErrorCode error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    // Connections inherit it; set before the handshake, as it bounds the window.
    if (!error) acceptor_.set_option(net::socket_base::send_buffer_size(kSendBufferBytes), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    return error;
  }

  void run() {
    port_ = acceptor_.local_endpoint().port();
    loopback_only_ = acceptor_.local_endpoint().address().is_loopback();
    encrypts_ = context_.security.tls != nullptr;
    accept();
    tick();
    thread_ = std::jthread([this] { io_.run(); });
    pthread_setname_np(thread_.native_handle(), "api");
  }

  void reconfigure(const Config::Api& config, Security security) {
    net::post(io_, [this, config, security = std::move(security)]() mutable {
      hub_.set_pose_rate(config.pose_rate_hz);
      context_.security = std::move(security);
      context_.visitors.set_rate(config.max_requests_per_s);
      context_.config = config;
      context_.guests.hold_to(context_.security.policy);
    });
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] bool encrypts() const { return encrypts_; }
  [[nodiscard]] bool loopback_only() const { return loopback_only_; }

 private:
  void accept() {
    acceptor_.async_accept([this](ErrorCode error, net::ip::tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (error) return pause(error);
      welcome(std::move(socket));
      accept();
    });
  }

  void welcome(net::ip::tcp::socket socket) {
    auto& counts = api_.counts();
    ++counts.accepted;
    ErrorCode ignored;
    const auto peer = parse_address(socket.remote_endpoint(ignored).address().to_string());
    if (ignored || !peer) return;  // gone again
    ConnectionSlot slot(context_.guests, context_.visitors.of(*peer, Visitors::Clock::now()));
    if (!seat(slot.guest())) {
      ++counts.refused;
      return;
    }
    socket.set_option(net::ip::tcp::no_delay(true), ignored);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &kUserTimeoutMs, sizeof kUserTimeoutMs);
    serve_http(std::move(socket), context_, std::move(slot));
  }

  /// Whether there is a place for who has shown nothing yet. Who is too much may say what he wants, which decides
  /// (`refusal`); beyond twice the limits there is no time for that.
  bool seat(Guest& guest) {
    const Visitor& visitor = *guest.visitor;
    const auto& counts = api_.counts();
    if (context_.crowded(visitor, visitor.connections, 2) && !context_.guests.make_room(guest, true)) return false;
    const bool full = context_.crowded(counts.connections) && !context_.guests.make_room(guest);
    guest.surplus = full || context_.crowded(visitor, visitor.connections);
    return !full || !context_.crowded(counts.connections, 2);
  }

  void pause(ErrorCode error) {
    spdlog::warn("api: a connection could not be accepted: {}", error.message());
    pause_.expires_after(kPause);
    pause_.async_wait([this](ErrorCode e) {
      if (!e) accept();
    });
  }

  void tick() {
    ticker_.expires_after(std::min(hub_.period(), foxglove_.period()));
    ticker_.async_wait([this](ErrorCode error) {
      if (error) return;
      const auto now = std::chrono::steady_clock::now();
      hub_.tick(now);
      foxglove_.tick(now);
      tick();
    });
  }

  // The thread uses all of them; connections live in the handlers that io_ holds, and refer to those above it.
  Api api_;
  StreamHub hub_;
  foxglove::Feed foxglove_;
  WebContext context_;
  net::io_context io_{1};
  net::thread_pool workshop_{1};  // after io_, to which it hands its work back
  net::ip::tcp::acceptor acceptor_{io_};
  net::steady_timer ticker_{io_}, pause_{io_};
  std::uint16_t port_ = 0;
  bool encrypts_ = false, loopback_only_ = false;
  std::jthread thread_;  // last: joined first
};

Started<Server> Server::open(const Config::Api& config, Sources sources, const Config::Suit& suit,
                             std::uint16_t suit_port, const ServerLimits& limits) {
  auto security = load_security(config);
  if (!security) return StartError{ExitCode::Config, security.error()};
  auto impl = std::make_unique<Impl>(config, *std::move(security), std::move(sources), suit, suit_port, limits);
  ErrorCode error;
  const auto address = net::ip::make_address(config.address, error);
  if (!error) error = impl->bind(address, config.port);
  if (error) return bind_error({"TCP", config.address, config.port, "api.port", "--port"}, error);
  impl->run();
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return impl_->port(); }
bool Server::encrypts() const { return impl_->encrypts(); }
bool Server::loopback_only() const { return impl_->loopback_only(); }

std::optional<Error> Server::reconfigure(const Config::Api& config) {
  auto security = load_security(config);
  if (!security) return Error{security.error()};
  if (security->from_credentials)
    spdlog::info(
        "api: tokens and certificate are the service's credentials, which systemd reads at its start only; where they "
        "have changed, systemctl restart kinemapd (the session goes on)");
  impl_->reconfigure(config, *std::move(security));
  return std::nullopt;
}

std::optional<Error> Server::check(const Config::Api& config) {
  auto security = load_security(config);
  return security ? std::nullopt : std::optional(Error{security.error()});
}

}  // namespace kinemap
