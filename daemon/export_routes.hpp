// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/routes.hpp"
#include "daemon/sources.hpp"

namespace kinemap {

/// /api/v1/export/NAME: the map as files that other programs read. `sources` must outlive the routes.
void add_export_routes(Routes& routes, const Sources& sources);

}  // namespace kinemap
