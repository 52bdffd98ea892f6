// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/routes.hpp"

namespace kinemap {

/// The live page at `/` (daemon/web). All its files lie in the program, since a wearable has no internet.
void add_page_routes(Routes& routes);

}  // namespace kinemap
