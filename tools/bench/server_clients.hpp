// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap::bench {

/// What the clients of `bench server` are to do; they run in a process of their own, so that their memory is theirs.
struct ClientsPlan {
  std::uint16_t port = 0;
  int readers = 180;
  int sleepers = 20;  ///< subscribe and never read
  double rate_hz = 10.0;
  double seconds = 30.0;
  double epoch_s = 0.0;  ///< stream time 0 on the steady clock, which all processes share
};

struct ClientsReport {
  std::map<std::string, std::vector<double>> delivery_ms;  ///< by topic: from when the frame, or map, was there
  int connected = 0;
  int lost = 0;  ///< readers whose connection ended before the time
};

ClientsReport run_clients(const ClientsPlan& plan);

/// The same in a child process: this program, started anew with the plan as arguments.
Result<ClientsReport> run_clients_apart(const ClientsPlan& plan);

}  // namespace kinemap::bench
