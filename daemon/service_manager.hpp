// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace kinemap {

/// Tells systemd, when it started us (Type=notify); nothing otherwise.
void notify_service_manager(const std::string& state);
/// How often systemd wants a sign of life (WatchdogSec=); nullopt when it wants none.
std::optional<std::chrono::milliseconds> watchdog_period();

/// systemd holds sockets of ours for as long as the service is not stopped (FileDescriptorStoreMax=), so that what
/// comes while a daemon that has died is started again waits in the kernel for the new one. Takes the UDP socket of
/// this name back from it; -1: it has none. systemd has let go of it then: should it not be wanted any more, its port
/// is free once we have closed it.
int take_kept_socket(const std::string& name);
/// Gives it one to keep; -1: none.
void keep_socket(const std::string& name, int socket);

}  // namespace kinemap
