// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/routes.hpp"

namespace kinemap {

/// The routes as OpenAPI 3.1, with the schemas of protocol/ as components: what clients are generated from, and what
/// the real answers are tested against.
std::string openapi_text(const Routes& routes, const std::string& version);

}  // namespace kinemap
