// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/body.hpp"

namespace kinemap {

/// Body height (m) as the bone lengths of the frame give it away: thigh, shank, upper arm and forearm make up 82.3 % of it (Drillis and
/// Contini 1966: 0.245, 0.246, 0.186, 0.146); mean of both sides. nullopt when the bones are no grown person's.
std::optional<double> stature_from_bones(const SuitFrame& frame);

}  // namespace kinemap
