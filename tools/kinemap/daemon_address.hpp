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
  bool tls = false;                        ///< https
  std::string fingerprint;                 ///< the only certificate that is right; empty: one that is vouched for
  std::string ca;                          ///< file of who may vouch, PEM; empty: whom the system trusts
  [[nodiscard]] std::string text() const;  ///< "http://host:port/path"
};

/// "http://host:port/path", "https://…", "host:port", "host", ":port"; what is missing is this machine's.
Result<DaemonAddress> parse_daemon_address(const std::string& url);

/// The options of every command that asks a daemon.
struct DaemonOptions {
  std::string url;          ///< empty: KINEMAP_URL, or else this machine's daemon
  std::string token;        ///< empty: KINEMAP_TOKEN
  std::string fingerprint;  ///< empty: KINEMAP_FINGERPRINT
  std::string ca;
};
CLI::Option* add_daemon_options(CLI::App& command, DaemonOptions& options);

/// The daemon that options and environment name. A token is for https and for this machine only.
Result<DaemonAddress> daemon_of(const DaemonOptions& options);

}  // namespace kinemap::cli
