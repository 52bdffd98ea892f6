// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap::bench {

/// The session that speed is measured on.
struct Scenario {
  std::string recording;  ///< .pcap
  double duration_s = 0.0;
  std::string name;  ///< "simulated session, seed 4, 3 rooms, 358 s"
};

/// Simulates into `directory` the default session (three rounds) that comes nearest to six minutes. With `recording` it
/// is that file instead.
Result<Scenario> make_scenario(const std::string& directory, const std::string& recording);

/// Value below which `part` of the values lie (nearest rank); `values` are sorted in place.
double percentile(std::vector<double>& values, double part);

}  // namespace kinemap::bench
