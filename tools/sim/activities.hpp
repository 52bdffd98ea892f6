// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/composer.hpp"

namespace kinemap::sim {

/// Walks to the chair, turns, sits some seconds, rises. False when it cannot be reached.
bool sit_on(Composer& composer, const Chair& chair);

/// Something that looks like an activity and means nothing, where the wearer stands (phone calls partly while walking).
void distract(Composer& composer);

}  // namespace kinemap::sim
