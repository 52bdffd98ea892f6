// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
// before Asio, which needs it
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>

namespace kinemap {

enum class Signal { End, Reload };

/// SIGINT, SIGTERM and SIGHUP, caught for the whole process and waited for in one place. They are handled, not only
/// blocked: libraries (OpenBLAS) start threads before main(), which have no part in our mask, and one of them taking
/// the signal must not end the daemon. A second SIGINT or SIGTERM, while the program ends, ends it at once.
class Signals {
 public:
  Signals();

  /// Waits for a signal, and calls `tick` each time that `period` has passed meanwhile.
  [[nodiscard]] Signal wait(std::chrono::milliseconds period, const std::function<void()>& tick);

 private:
  boost::asio::io_context context_;
  boost::asio::signal_set set_;
  boost::asio::steady_timer timer_;
};

}  // namespace kinemap
