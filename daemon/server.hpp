// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "daemon/api.hpp"
#include "daemon/config.hpp"
#include "daemon/start.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// Times that no user needs to change.
struct ServerLimits {
  /// A stream's client must take each message within this time, and a second more for each 64 KiB, or is disconnected.
  std::chrono::milliseconds stall{15000};
  /// The first request must have come whole within this time of the connection, TLS handshake included.
  std::chrono::milliseconds request{10000};
};

/// The HTTP and WebSocket server on its own thread. It reads snapshots only: nothing on the way from the suit to the
/// map waits for it.
class Server {
 public:
  /// Binds at once; port 0 lets the kernel choose (`port()` tells). `suit` and `suit_port` are for the status page.
  static Started<Server> open(const Config::Api& config, Sources sources, const Config::Suit& suit,
                              std::uint16_t suit_port, const ServerLimits& limits = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// As it started.
  [[nodiscard]] bool encrypts() const;
  [[nodiscard]] bool loopback_only() const;
  /// Takes over all but address and port, and reads the files of tokens and TLS again: connections that are open keep
  /// their certificate, each request of theirs is held against the new tokens, and WebSockets that would not be let in
  /// any more are closed. An Error leaves all as it was. Any thread.
  std::optional<Error> reconfigure(const Config::Api& config);
  /// Why a server so configured would not start, but for its port; it reads the files that are named.
  static std::optional<Error> check(const Config::Api& config);

 private:
  class Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
