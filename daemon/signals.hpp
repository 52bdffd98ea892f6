// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace kinemap {

enum class Signal { End, Reload };

/// SIGINT, SIGTERM and SIGHUP, caught for the whole process and waited for in one place. They are handled, not only
/// blocked: libraries (OpenBLAS) start threads before main(), which have no part in our mask, and one of them taking
/// the signal must not end the daemon. A second SIGINT or SIGTERM, while the program ends, ends it at once.
class Signals {
 public:
  Signals();

  [[nodiscard]] Signal wait();

 private:
  boost::asio::io_context context_;
  boost::asio::signal_set set_;
};

/// Tells systemd, when it started us (Type=notify); nothing otherwise.
void notify_service_manager(const char* state);

/// Messages go to stderr, which systemd's journal keeps.
void set_up_logging();

}  // namespace kinemap
