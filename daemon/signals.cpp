// SPDX-License-Identifier: Apache-2.0
#include "daemon/signals.hpp"

#include <csignal>

namespace kinemap {

Signals::Signals() : set_(context_, SIGINT, SIGTERM, SIGHUP), timer_(context_) {
  // A client that goes away while it is written to is an error code, not the end.
  std::signal(SIGPIPE, SIG_IGN);
}

Signal Signals::wait(std::chrono::milliseconds period, const std::function<void()>& tick) {
  int caught = 0;
  set_.async_wait([&](const boost::system::error_code&, int signal) {
    caught = signal;
    timer_.cancel();
  });
  const std::function<void()> sleep = [&] {
    timer_.expires_after(period);
    timer_.async_wait([&](const boost::system::error_code& error) {
      if (error || caught != 0) return;
      tick();
      sleep();
    });
  };
  sleep();
  context_.restart();
  context_.run();
  if (caught == SIGHUP) return Signal::Reload;
  set_.clear();
  return Signal::End;
}

}  // namespace kinemap
