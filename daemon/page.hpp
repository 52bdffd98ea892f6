// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

namespace kinemap {

/// The page at `/`: what the daemon receives, and the floor plan; one self-contained HTML text.
std::shared_ptr<const std::string> status_page();

}  // namespace kinemap
