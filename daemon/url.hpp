// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinemap {

/// The parameters of a query, decoded, in their order.
using Params = std::vector<std::pair<std::string, std::string>>;

/// "/api/v1/objects?type=wall" taken apart and decoded.
struct Target {
  std::string path;
  Params params;
};

/// nullopt when an escape is broken (%2, %zz) or hides a control character, or when the target is not a path.
std::optional<Target> parse_target(std::string_view target);

}  // namespace kinemap
