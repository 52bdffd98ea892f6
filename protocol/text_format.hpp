// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinemap {

/// printf to a string.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

}  // namespace kinemap
