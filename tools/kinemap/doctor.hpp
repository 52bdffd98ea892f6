// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "tools/kinemap/daemon_address.hpp"

/// The checks of `kinemap doctor`. Each looks at one thing that keeps Kinemap from mapping and says what to do about
/// it.
namespace kinemap::cli {

struct Finding {
  enum class Verdict : std::uint8_t {
    Ok,
    Note,     ///< it works without, or may be meant so
    Problem,  ///< it does not work, or something is lost
  };
  Verdict verdict = Verdict::Ok;
  std::string subject;  ///< "suit", "disk", …
  std::string text;     ///< what is so
  std::string advice;   ///< what to do; empty when there is nothing
};

using Findings = std::vector<Finding>;

/// How the daemon of this configuration guards itself, and so what it is to be shown.
struct Access {
  Finding finding;
  bool tls = false;
  std::string token, fingerprint;  ///< empty: none is needed, or this user may not read it
};
/// `config_path`: empty where there is no file. Reads tokens and certificate as kinemapd does.
Access check_access(const Config& config, const std::string& config_path);

/// Whether a kinemapd answers at `daemon`, and if not, whether it could be started. `status` becomes the daemon's
/// /api/v1/status, or null.
Finding check_daemon(const Config& config, const DaemonAddress& daemon, nlohmann::ordered_json& status);
/// Whether the suit's stream arrives: what the running daemon says of it, or, where none runs, what comes to the port
/// within `listen_s`. As root the port stays free meanwhile; else nothing else can open it, which is said on stderr.
Findings check_suit(const Config& config, const nlohmann::ordered_json& status, double listen_s);

// Of the system; doctor_system.cpp.
Finding check_service();                       ///< systemd's unit
Finding check_firewall(const Config& config);  ///< a hint: which ports go through is for the firewall's own tools
Finding check_receive_buffer(const Config& config);
Finding check_clock();
Finding check_disk(const Config& config);

}  // namespace kinemap::cli
