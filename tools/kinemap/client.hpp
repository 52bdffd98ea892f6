// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "tools/kinemap/daemon_address.hpp"

namespace kinemap::cli {

/// The body of GET `target`. An Error says what to do: daemon not running, wrong port, a token that is missing, or the
/// daemon's own message.
Result<std::string> http_get(const DaemonAddress& daemon, const std::string& target);

/// Text as it may stand in a URL's query: all but letters, digits, commas and -._~ as %XX.
std::string url_encoded(const std::string& text);

/// One WebSocket connection to the daemon's /api/v1/stream.
class StreamClient {
 public:
  /// Connects and sends `subscribe` (a JSON text) first.
  static Result<StreamClient> connect(const DaemonAddress& daemon, const std::string& subscribe);
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
