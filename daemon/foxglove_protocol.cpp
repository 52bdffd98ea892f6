// SPDX-License-Identifier: Apache-2.0
#include "daemon/foxglove_protocol.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/json_params.hpp"

namespace kinemap::foxglove {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kSubprotocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// First byte of binary messages.
enum class ServerOp : std::uint8_t { MessageData = 1, Time = 2, ServiceResponse = 3 };
constexpr char kServiceRequest = 2;

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

template <std::unsigned_integral T>
void put(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
}

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::optional<std::uint32_t> u32_of(const Json& json) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > 0xFFFFFFFFU) return std::nullopt;
  return json.get<std::uint32_t>();
}

std::uint32_t id_of(Channel channel) { return static_cast<std::uint32_t>(channel) + 1; }

std::optional<Channel> channel_of(std::uint32_t id) {
  const auto it = std::find_if(kChannels.begin(), kChannels.end(), [id](Channel c) { return id_of(c) == id; });
  return it == kChannels.end() ? std::nullopt : std::optional(*it);
}

ClientMessage subscribe_of(const Json& message) {
  const auto list = message.find("subscriptions");
  const BadMessage bad{R"("subscribe" needs "subscriptions": a list of {"id", "channelId"}, whole numbers)"};
  if (list == message.end() || !list->is_array()) return bad;
  Subscribe subscribe;
  for (const Json& item : *list) {
    if (!item.is_object()) return bad;
    const auto id = u32_of(item.value("id", Json())), channel_id = u32_of(item.value("channelId", Json()));
    if (!id || !channel_id) return bad;
    const auto channel = channel_of(*channel_id);
    if (!channel) return BadMessage{"there is no channel " + std::to_string(*channel_id) + "; \"advertise\" has them"};
    subscribe.items.push_back({*id, *channel});
  }
  return subscribe;
}

ClientMessage unsubscribe_of(const Json& message) {
  const auto list = message.find("subscriptionIds");
  const BadMessage bad{R"("unsubscribe" needs "subscriptionIds": a list of whole numbers)"};
  if (list == message.end() || !list->is_array()) return bad;
  Unsubscribe unsubscribe;
  for (const Json& item : *list) {
    const auto id = u32_of(item);
    if (!id) return bad;
    unsubscribe.ids.push_back(*id);
  }
  return unsubscribe;
}

/// The client's own text in a message to it: bytes that are no UTF-8 are replaced.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

std::optional<std::string> choose_subprotocol(std::string_view offered) {
  while (!offered.empty()) {
    const auto comma = std::min(offered.find(','), offered.size());
    const auto name = trimmed(offered.substr(0, comma));
    if (std::find(kSubprotocols.begin(), kSubprotocols.end(), name) != kSubprotocols.end()) return std::string(name);
    offered.remove_prefix(std::min(comma + 1, offered.size()));
  }
  return std::nullopt;
}

ClientMessage parse_text(std::string_view text) {
  const Json message = parse_message(text);
  if (message.is_discarded() || !message.is_object()) return BadMessage{"a text message is a JSON object with \"op\""};
  const auto op_it = message.find("op");
  const std::string op = op_it != message.end() && op_it->is_string() ? op_it->get<std::string>() : std::string();
  if (op == "subscribe") return subscribe_of(message);
  if (op == "unsubscribe") return unsubscribe_of(message);
  return BadMessage{"\"op\" " + op.substr(0, 40) +
                    " is not served; there are subscribe, unsubscribe, and service requests in binary"};
}

ClientMessage parse_binary(std::string_view bytes) {
  constexpr std::size_t kHead = 13;
  if (bytes.empty() || bytes[0] != kServiceRequest)
    return BadMessage{"of binary messages only service requests (first byte 2) are served"};
  if (bytes.size() < kHead) return BadMessage{"a service request has 13 bytes at least"};
  const std::uint32_t encoding = u32(bytes, 9);
  if (encoding > bytes.size() - kHead) return BadMessage{"the service request's encoding is longer than the message"};
  return ServiceCall{u32(bytes, 1), u32(bytes, 5), std::string(bytes.substr(kHead, encoding)),
                     std::string(bytes.substr(kHead + encoding))};
}

std::string server_info_text(const std::string& session_id) {
  return text_of({{"op", "serverInfo"},
                  {"name", "kinemap"},
                  {"capabilities", {"time", "services"}},
                  {"supportedEncodings", {"json"}},
                  {"metadata", Json::object()},
                  {"sessionId", session_id}});
}

std::string advertise_text() {
  Json channels = Json::array();
  for (const Channel channel : kChannels)
    channels.push_back({{"id", id_of(channel)},
                        {"topic", topic(channel)},
                        {"encoding", "json"},
                        {"schemaName", schema_name(channel)},
                        {"schemaEncoding", "jsonschema"},
                        {"schema", schema_text(channel)}});
  return text_of({{"op", "advertise"}, {"channels", std::move(channels)}});
}

std::string status_message_text(StatusLevel level, const std::string& message) {
  return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string service_failure_text(const ServiceCall& call, const std::string& message) {
  return text_of(
      {{"op", "serviceCallFailure"}, {"serviceId", call.service}, {"callId", call.call}, {"message", message}});
}

std::string message_head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string bytes(1, static_cast<char>(ServerOp::MessageData));
  put(bytes, subscription);
  put(bytes, time_ns);
  return bytes;
}

std::string time_bytes(std::uint64_t time_ns) {
  std::string bytes(1, static_cast<char>(ServerOp::Time));
  put(bytes, time_ns);
  return bytes;
}

std::string service_response_head(const ServiceCall& call) {
  constexpr std::string_view kEncoding = "json";
  std::string bytes(1, static_cast<char>(ServerOp::ServiceResponse));
  put(bytes, call.service);
  put(bytes, call.call);
  put(bytes, static_cast<std::uint32_t>(kEncoding.size()));
  return bytes.append(kEncoding);
}

}  // namespace kinemap::foxglove
