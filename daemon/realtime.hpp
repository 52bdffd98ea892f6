// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <thread>

namespace kinemap {

/// Real-time scheduling (SCHED_FIFO) of one thread: it runs as soon as it has something to do, before all ordinary
/// ones. Empty; or why the kernel refuses, and what to do about it: the thread then goes on as before. `priority`: 1
/// to 99.
std::string set_realtime(std::thread::native_handle_type thread, int priority);

}  // namespace kinemap
