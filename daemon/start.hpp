// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <system_error>
#include <variant>

namespace kinemap {

/// What kinemapd returns to its caller.
enum class ExitCode : int { Ok = 0, Failure = 1, Config = 2, PortTaken = 3 };

/// Why a part could not be started, for people, and with which code the program ends.
struct StartError {
  ExitCode code = ExitCode::Failure;
  std::string message;
};

template <class T>
using Started = std::variant<std::unique_ptr<T>, StartError>;

/// Where a socket was to be bound, and how a user changes that.
struct Binding {
  const char* protocol;  ///< "UDP" or "TCP"
  std::string address;
  std::uint16_t port;
  const char* key;     ///< "suit.port"
  const char* option;  ///< "--suit-port"
};

/// Says what is wrong with a port or an address and what to do.
StartError bind_error(const Binding& binding, std::error_code reason);

}  // namespace kinemap
