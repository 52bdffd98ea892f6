// SPDX-License-Identifier: Apache-2.0
#include "daemon/service_manager.hpp"

#include <cstdint>

#ifdef KINEMAP_SYSTEMD
#include <sys/socket.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <cstdlib>
#endif

namespace kinemap {
namespace {

[[maybe_unused]] constexpr std::uint64_t kPatienceUs = 2'000'000;  // with systemd

}  // namespace

void notify_service_manager([[maybe_unused]] const std::string& state) {
#ifdef KINEMAP_SYSTEMD
  sd_notify(0, state.c_str());
#endif
}

std::optional<std::chrono::milliseconds> watchdog_period() {
#ifdef KINEMAP_SYSTEMD
  std::uint64_t microseconds = 0;
  if (sd_watchdog_enabled(0, &microseconds) > 0) return std::chrono::milliseconds(microseconds / 1000);
#endif
  return std::nullopt;
}

int take_kept_socket([[maybe_unused]] const std::string& name) {
  int found = -1;
#ifdef KINEMAP_SYSTEMD
  char** names = nullptr;
  const int count = sd_listen_fds_with_names(0, &names);
  for (int i = 0; i < count; ++i) {
    const int socket = SD_LISTEN_FDS_START + i;
    const bool wanted = found < 0 && names[i] == name && sd_is_socket(socket, AF_UNSPEC, SOCK_DGRAM, -1) > 0;
    if (wanted)
      found = socket;
    else
      ::close(socket);
    std::free(names[i]);
  }
  std::free(names);
  if (found >= 0) {
    notify_service_manager("FDSTOREREMOVE=1\nFDNAME=" + name);
    sd_notify_barrier(0, kPatienceUs);
  }
#endif
  return found;
}

void keep_socket([[maybe_unused]] const std::string& name, [[maybe_unused]] int socket) {
#ifdef KINEMAP_SYSTEMD
  // Without FDPOLL=0 systemd would let go of it at the first error, such as an ICMP message.
  const std::string state = "FDSTORE=1\nFDPOLL=0\nFDNAME=" + name;
  if (socket >= 0) sd_pid_notify_with_fds(0, 0, state.c_str(), &socket, 1);
#endif
}

}  // namespace kinemap
