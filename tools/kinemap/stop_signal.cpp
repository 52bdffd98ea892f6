// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/stop_signal.hpp"

#include <algorithm>
#include <csignal>
#include <ctime>

namespace kinemap::cli {
namespace {
volatile std::sig_atomic_t g_stop = 0;  // what a signal handler may touch
}

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: sleeps and waits are interrupted
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() { return g_stop != 0; }

void sleep_until(std::chrono::steady_clock::time_point time) {
  // In slices, so that a signal that lands just before the sleep is seen too.
  constexpr auto kSlice = std::chrono::milliseconds(100);
  while (!stop_requested()) {
    const auto left = time - std::chrono::steady_clock::now();
    if (left <= left.zero()) return;
    const auto nap =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::min<decltype(left)>(left, kSlice)).count();
    const timespec span{.tv_sec = nap / 1'000'000'000, .tv_nsec = nap % 1'000'000'000};
    ::nanosleep(&span, nullptr);
  }
}

}  // namespace kinemap::cli
