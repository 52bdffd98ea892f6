// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/bench/accuracy.hpp"

namespace kinemap::bench {

/// A floor plan of a session, the truth in grey beneath the map, both trajectories over it; the object with the true id
/// `culprit` is underlined. SVG.
std::string session_svg(const Session& session, std::optional<std::uint32_t> culprit);

}  // namespace kinemap::bench
