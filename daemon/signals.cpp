// SPDX-License-Identifier: Apache-2.0
#include "daemon/signals.hpp"

#include <pthread.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#ifdef KINEMAP_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

#include <memory>

namespace kinemap {

BlockedSignals::BlockedSignals() {
  sigemptyset(&set_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, signal);
  pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  // A client that goes away while it is written to is an error code, not the end.
  std::signal(SIGPIPE, SIG_IGN);
}

Signal BlockedSignals::wait() const {
  int signal = 0;
  while (sigwait(&set_, &signal) != 0) {
  }
  if (signal == SIGHUP) return Signal::Reload;
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGINT);
  sigaddset(&ending, SIGTERM);
  pthread_sigmask(SIG_UNBLOCK, &ending, nullptr);
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
