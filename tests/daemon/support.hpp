// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live_body.hpp"
#include "protocol/wire/mxtp.hpp"

namespace kinemap::test {

/// Waits for something that another thread or process brings about. The limit is only there so that a failure ends.
inline bool eventually(const std::function<bool()>& condition, std::chrono::seconds limit = std::chrono::seconds(60)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// A body that stands upright with its pelvis at `p` of the odom frame, and all of it there.
LiveBody body_at(double time_s, const Eigen::Vector3d& p);

/// Sample `index` of a wearer in T-pose who glides forward (+x) at 1 m/s, 120 samples per second: one datagram.
mxtp::Bytes glider_datagram(std::uint32_t index, std::uint8_t character = 0);

/// "name:…" of that wearer, type 12.
mxtp::Bytes name_datagram(const std::string& name, std::uint8_t character = 0);

}  // namespace kinemap::test
