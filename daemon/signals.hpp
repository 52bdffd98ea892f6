// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>

namespace kinemap {

enum class Signal { End, Reload };

/// Holds SIGINT, SIGTERM and SIGHUP back from this thread and all that it starts, to be waited for in one place. A
/// second SIGINT or SIGTERM, while the program ends, ends it at once.
class BlockedSignals {
 public:
  BlockedSignals();
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

  [[nodiscard]] Signal wait() const;

 private:
  sigset_t set_;
};

/// Tells systemd, when it started us (Type=notify); nothing otherwise.
void notify_service_manager(const char* state);

/// Messages go to stderr, which systemd's journal keeps.
void set_up_logging();

}  // namespace kinemap
