// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/kinemap/endpoint.hpp"

namespace kinemap::cli {

inline constexpr std::uint16_t kApiPort = 8765;

/// Where a kinemapd answers, and what it is shown.
struct DaemonAddress {
  Endpoint endpoint;
  std::string path;                        ///< before /api/v1, as "/kinemap": a proxy's; mostly empty
  std::string token;                       ///< sent as "Authorization: Bearer …"; empty: none
  [[nodiscard]] std::string text() const;  ///< "http://host:port/path"
};

/// "http://host:port/path", "host:port", "host", ":port". Plain HTTP only; what is missing is this machine's.
Result<DaemonAddress> parse_daemon_address(const std::string& url);

/// The options of every command that asks a daemon.
struct DaemonOptions {
  std::string url;  ///< empty: KINEMAP_URL, or else this machine's daemon
};
CLI::Option* add_daemon_options(CLI::App& command, DaemonOptions& options);

/// The daemon that options and environment (KINEMAP_URL, KINEMAP_TOKEN) name.
Result<DaemonAddress> daemon_of(const DaemonOptions& options);

}  // namespace kinemap::cli
