// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "tools/sim/building.hpp"
#include "tools/sim/options.hpp"
#include "tools/sim/score.hpp"
#include "tools/sim/wearer.hpp"

namespace kinemap::sim {

/// What the wearer did, and which objects were touched or sat on (ids).
struct Script {
  Score score;
  std::set<int> visited;             ///< in any round
  std::vector<double> round_ends_s;  ///< end of each round
};

/// Writes a whole session: stands, goes round the rooms two or three times, touching and sitting.
Script write_script(const SimOptions& options, const Building& building, const Wearer& wearer, Random& random);

}  // namespace kinemap::sim
