// SPDX-License-Identifier: Apache-2.0
#include "daemon/config.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>

/// What is taken reads back as the same; what is refused says why.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto config = kinemap::config_from_text(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
  if (!config) {
    if (config.error().find("fuzz") == std::string::npos) std::abort();
    return 0;
  }
  const auto again = kinemap::config_from_text(kinemap::to_json(*config).dump(), "again");
  if (!again || !kinemap::changed_keys(*config, *again).empty()) std::abort();
  return 0;
}
