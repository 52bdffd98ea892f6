// SPDX-License-Identifier: Apache-2.0
// A message of the stream; or, when the first byte is 'T' or 'B', of Foxglove's protocol: text or binary.
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
#include <variant>

#include "daemon/foxglove_protocol.hpp"
#include "daemon/stream_protocol.hpp"
#include "tests/fuzz/world.hpp"

namespace {

using namespace kinemap;

void stream(std::string_view text) {
  const ClientMessage message = parse_client_message(text);
  std::string answer;
  if (const auto* query = std::get_if<StreamQuery>(&message))
    answer = result_text(query->id, *fuzz::api().query(query->path, query->params).body);
  else if (const auto* bad = std::get_if<BadMessage>(&message))
    answer = stream_error_text(bad->id, error_text(bad->error));
  else if (const auto* subscribe = std::get_if<Subscribe>(&message))
    answer = subscribed_text(subscribe->topics, {});
  else
    return;
  if (!nlohmann::json::accept(answer)) std::abort();
}

void foxglove_message(const foxglove::ClientMessage& message) {
  if (const auto* bad = std::get_if<foxglove::BadMessage>(&message)) {
    const auto answer = foxglove::status_message_text(foxglove::StatusLevel::Error, bad->message);
    if (bad->message.empty() || !nlohmann::json::accept(answer)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with('T'))
    foxglove_message(foxglove::parse_text(bytes.substr(1)));
  else if (bytes.starts_with('B'))
    foxglove_message(foxglove::parse_binary(bytes.substr(1)));
  else
    stream(bytes);
  return 0;
}
