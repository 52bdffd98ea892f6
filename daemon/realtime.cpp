// SPDX-License-Identifier: Apache-2.0
#include "daemon/realtime.hpp"

#include <pthread.h>
#include <sched.h>

#include <system_error>

namespace kinemap {

std::string set_realtime(std::thread::native_handle_type thread, int priority) {
  const sched_param param{.sched_priority = priority};
  const int error = ::pthread_setschedparam(thread, SCHED_FIFO, &param);
  if (error == 0) return {};
  const auto number = std::to_string(priority);
  return "the kernel refuses real-time priority " + number + ": " + std::generic_category().message(error) +
         "; as a service it wants a drop-in with LimitRTPRIO=" + number +
         ", RestrictRealtime=no and SystemCallFilter=sched_setscheduler (systemd/README.md), elsewhere `ulimit -r " +
         number + "`";
}

}  // namespace kinemap
