// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/status.hpp"

namespace kinemap {

/// /metrics, in Prometheus' text format; daemon/README.md says what to look at.
std::string metrics_text(const Status& status);

}  // namespace kinemap
