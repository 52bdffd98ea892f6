// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "protocol/wire/result.hpp"

namespace kinemap::cli {

struct Endpoint {
  std::string host;
  std::uint16_t port = 0;
  [[nodiscard]] std::string text() const;  ///< "host:port", "[v6]:port"
};

/// "host:port", "host", ":port", "[v6]:port" or "[v6]"; what is missing comes from the defaults.
Result<Endpoint> parse_endpoint(const std::string& text, const std::string& default_host, std::uint16_t default_port);

}  // namespace kinemap::cli
