// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/mapper/config.hpp"
#include "core/tracker/config.hpp"
#include "protocol/assembler.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// Everything that can be configured; each part owns its struct and its defaults, this only aggregates.
/// config/default.json holds every key at its default and config/README.md explains each.
struct Config {
  struct Suit {
    std::string transport = "udp";  ///< "udp" or "tcp" (MVN connects to us)
    std::string address = "0.0.0.0";
    std::uint16_t port = 9763;
    int receive_buffer_bytes = 4194304;
    std::vector<std::string> allow = {};  ///< addresses and networks that may send; empty: all
  } suit;
  AssemblerConfig stream;
  TrackerConfig tracker;
  MapperConfig mapper;
  struct Detection {
    int realtime_priority = 0;  ///< of the thread that the tracker runs in: SCHED_FIFO; 0: scheduled as all others
  } detection;
  struct Api {
    std::string address = "127.0.0.1";
    std::uint16_t port = 8765;
    std::string auth = "remote";  ///< who must show a token: "remote" (all but this machine), "always", "none"
    std::string tokens;           ///< file; empty, as the two below: a credential of systemd, if there is one
    std::string certificate;      ///< file, PEM
    std::string key;              ///< file, PEM
    std::vector<std::string> allowed_hosts;    ///< names of this machine beyond those that it knows itself
    std::vector<std::string> allowed_origins;  ///< pages of other hosts that may open WebSockets
    double pose_rate_hz = 20.0;                ///< how often the stream pushes the pose
    int max_clients = 64;
    int max_clients_per_address = 16;
    double max_requests_per_s = 100.0;          ///< of one address
    std::size_t client_buffer_bytes = 4194304;  ///< a slower client loses messages beyond it, then its connection
  } api;
  struct Journal {
    std::string directory;  ///< empty: $STATE_DIRECTORY, which systemd sets; where that is not set, there is no journal
    double keep_days = 90.0;
    double keep_mb = 8192.0;
    double min_free_mb = 256.0;
    bool record = false;  ///< the suit's datagrams too
    double record_file_mb = 64.0;
    double record_file_min = 30.0;
  } journal;
  struct Log {
    std::string level = "info";  ///< trace, debug, info, warn, error; SIGHUP rereads it
  } log;
};

/// Reads a config text (JSON with // and /* */ comments). Refuses, never repairs: unknown key, wrong type or range →
/// the full key path and what is allowed; a syntax error → line and column. `path` is for the message only.
Result<Config> config_from_text(const std::string& text, const std::string& path);
/// The file, then over it each conf.d/*.json beside it, by name: what programs write does not touch the file of people.
Result<Config> config_from_file(const std::string& path);
/// Every key with its value.
nlohmann::ordered_json to_json(const Config& config);

/// One key as the documentation has it.
struct ConfigKey {
  std::string path;           ///< "tracker.key_poses.distance_m"
  std::string unit;           ///< "" where there is none
  std::string default_value;  ///< as JSON
  std::string allowed;        ///< "0.01 to 10 m", "\"udp\", \"tcp\""
};
/// Every key, in the order of config/default.json.
std::vector<ConfigKey> config_keys();
/// The paths of all keys in which the two differ.
std::vector<std::string> changed_keys(const Config& a, const Config& b);

}  // namespace kinemap
