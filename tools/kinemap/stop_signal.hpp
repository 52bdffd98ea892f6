// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace kinemap::cli {

/// From now on SIGINT and SIGTERM do not end the program but make stop_requested() true and cut waits short. A second
/// one does end it.
void catch_stop_signals();
bool stop_requested();

/// Sleeps until `time`, or until a stop is requested.
void sleep_until(std::chrono::steady_clock::time_point time);

}  // namespace kinemap::cli
