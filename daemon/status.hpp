// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/map.hpp"
#include "daemon/config.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/receiver.hpp"

namespace kinemap {

/// What the server counts; its thread only.
struct ApiCounts {
  std::uint64_t connections = 0;  ///< open now, HTTP and WebSocket
  std::uint64_t streams = 0;      ///< of these, WebSocket
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;  ///< beyond api.max_clients or api.max_clients_per_address
  std::uint64_t requests = 0;
  std::uint64_t errors = 0;            ///< answers with a status of 400 and above
  std::uint64_t messages_skipped = 0;  ///< news that a slow client did not get, since newer ones were there
  std::uint64_t slow_clients_closed = 0;
  std::uint64_t slow_requests_closed = 0;  ///< whose handshake or header did not come in time
  std::uint64_t gave_way = 0;              ///< connections that asked for nothing, closed when there were too many
  std::uint64_t displaced = 0;             ///< the same of those in use, for somebody with a better claim
  std::uint64_t revoked = 0;               ///< WebSockets closed since they would not be let in any more
  std::uint64_t handshakes_failed = 0;     ///< TLS
  std::uint64_t unauthorized = 0;          ///< without a token that is known, or for more than the token allows
  std::uint64_t forbidden = 0;             ///< by host, by origin, in the clear
  std::uint64_t throttled = 0;             ///< requests beyond api.max_requests_per_s
};

/// Everything that the status page shows.
struct Status {
  double uptime_s = 0.0;
  Config::Suit suit_config;
  std::uint16_t suit_port = 0;  ///< the port in use
  ReceiverState suit;
  PipelineStats pipeline;
  std::shared_ptr<const MapSnapshot> map;
  LiveBody body;
  ApiCounts api;
};

/// By how much the map's correction moves and turns the wearer, against what the suit says.
struct Drift {
  double distance_m = 0.0;
  double turn_rad = 0.0;
};
/// Nullopt before the first frame.
std::optional<Drift> corrected_drift(const Status& status);

/// Frames came within the last 2 s.
bool is_receiving(const ReceiverState& suit);

/// JSON of /api/v1/status; protocol/README.md explains each field.
std::string status_text(const Status& status);

/// JSON of /healthz: {"status": "ok" | "waiting" | "refused", "message": …}. "ok": frames came within the last 2 s.
std::string health_text(const Status& status);

}  // namespace kinemap
