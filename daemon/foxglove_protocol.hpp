// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/foxglove/channels.hpp"

/// The messages of the Foxglove WebSocket protocol, both ways; protocol/README.md says which part of it is spoken.
namespace kinemap::foxglove {

/// The one to speak of those that a client offers ("a, b"); nullopt when we speak none of them.
std::optional<std::string> choose_subprotocol(std::string_view offered);

struct Subscribe {
  struct Item {
    std::uint32_t id;  ///< the client's
    Channel channel;
  };
  std::vector<Item> items;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string encoding;
  std::string payload;
};
struct BadMessage {
  std::string message;
};
using ClientMessage = std::variant<Subscribe, Unsubscribe, ServiceCall, BadMessage>;

/// Never throw: whatever is wrong becomes a BadMessage that says what is allowed.
ClientMessage parse_text(std::string_view text);
ClientMessage parse_binary(std::string_view bytes);

std::string server_info_text(const std::string& session_id);
std::string advertise_text();
enum class StatusLevel : std::uint8_t { Info, Warning, Error };
std::string status_message_text(StatusLevel level, const std::string& message);
std::string service_failure_text(const ServiceCall& call, const std::string& message);

std::string message_head(std::uint32_t subscription, std::uint64_t time_ns);  ///< the message's JSON follows
std::string time_bytes(std::uint64_t time_ns);
std::string service_response_head(const ServiceCall& call);  ///< the answer's JSON follows

}  // namespace kinemap::foxglove
