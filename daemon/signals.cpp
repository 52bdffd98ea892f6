// SPDX-License-Identifier: Apache-2.0
#include "daemon/signals.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#ifdef KINEMAP_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

#include <csignal>
#include <memory>

namespace kinemap {

Signals::Signals() : set_(context_, SIGINT, SIGTERM, SIGHUP) {
  // A client that goes away while it is written to is an error code, not the end.
  std::signal(SIGPIPE, SIG_IGN);
}

Signal Signals::wait() {
  int caught = 0;
  set_.async_wait([&](const boost::system::error_code&, int signal) { caught = signal; });
  context_.restart();
  context_.run();
  if (caught == SIGHUP) return Signal::Reload;
  set_.clear();
  return Signal::End;
}

void notify_service_manager([[maybe_unused]] const char* state) {
#ifdef KINEMAP_SYSTEMD
  sd_notify(0, state);
#endif
}

void set_up_logging() {
  auto logger = std::make_shared<spdlog::logger>("kinemapd", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace kinemap
