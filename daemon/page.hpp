// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/routes.hpp"

namespace kinemap {

/// The page at `/`: what the daemon receives, and the floor plan. All its files are in memory, since a wearable has no
/// internet.
void add_page_routes(Routes& routes);

}  // namespace kinemap
