// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "tools/kinemap/endpoint.hpp"

namespace kinemap::cli {

/// Sends datagrams with the spacing that they were captured with, `speed` times as fast (0: without any wait).
class PacedSender {
 public:
  static Result<PacedSender> create(const Endpoint& to, double speed);
  ~PacedSender();
  PacedSender(PacedSender&&) noexcept;
  PacedSender& operator=(PacedSender&&) noexcept;

  /// Waits until the datagram of stream time `time_s` is due (relative to the first one's), then sends it. False when
  /// the wait was cut short by a signal, or the datagram cannot be sent at all (see error()).
  bool send(double time_s, std::span<const std::byte> datagram);

  [[nodiscard]] std::uint64_t sent() const;
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t refused() const;  ///< datagrams after which the other side said that nobody listens there
  [[nodiscard]] double stream_s() const;        ///< stream time sent so far
  [[nodiscard]] const std::optional<Error>& error() const;

 private:
  class Impl;
  explicit PacedSender(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// What was sent, for people; names the port when nobody listened.
std::string sending_report(const PacedSender& sender, const Endpoint& to);

}  // namespace kinemap::cli
