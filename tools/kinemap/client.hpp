// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "tools/kinemap/endpoint.hpp"

namespace kinemap::cli {

inline constexpr std::uint16_t kApiPort = 8765;

/// The body of GET `target`. An Error says what to do: daemon not running, wrong port, or the daemon's own message.
Result<std::string> http_get(const Endpoint& daemon, const std::string& target);

/// One WebSocket connection to the daemon's /api/v1/stream.
class StreamClient {
 public:
  /// Connects and sends `subscribe` (a JSON text) first.
  static Result<StreamClient> connect(const Endpoint& daemon, const std::string& subscribe);
  ~StreamClient();
  StreamClient(StreamClient&&) noexcept;
  StreamClient& operator=(StreamClient&&) noexcept;

  /// The next message; nullopt when none came within `timeout`; an Error when the connection is gone.
  Result<std::optional<std::string>> next(std::chrono::milliseconds timeout);

 private:
  class Impl;
  explicit StreamClient(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap::cli
