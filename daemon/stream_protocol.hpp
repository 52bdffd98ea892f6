// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/answer.hpp"
#include "daemon/map_history.hpp"
#include "daemon/outbox.hpp"
#include "daemon/url.hpp"

/// The JSON messages of /api/v1/stream, both ways; protocol/README.md is the specification.
namespace kinemap {

struct Subscribe {
  std::vector<Topic> topics;
  std::optional<double> rate_hz;  ///< of pose and body, where they are among the topics
  std::optional<KnownMap> known;  ///< the map that the client has
};
struct Unsubscribe {
  std::vector<Topic> topics;  ///< all of them when the client named none
};
struct StreamQuery {
  std::string id;  ///< JSON text of the client's id, sent back as it came
  std::string path;
  Params params;
};
struct BadMessage {
  std::string id;  ///< JSON text; empty when the message had none
  ApiError error;
};
using ClientMessage = std::variant<Subscribe, Unsubscribe, StreamQuery, BadMessage>;

constexpr double kSlowestHz = 0.1, kFastestHz = 240.0;  ///< rates that a client may choose; 240 Hz is MVN's fastest

/// Never throws: whatever is wrong becomes a BadMessage that says what is allowed.
ClientMessage parse_client_message(std::string_view text);

/// {"op":"subscribed","topics":[…],"rate_hz":{"pose":…}}: `rates_hz` has the rate of each topic that has one.
std::string subscribed_text(const std::vector<Topic>& topics, const std::vector<std::pair<Topic, double>>& rates_hz);
std::string result_text(const std::string& id, const std::string& data);  ///< {"op":"result","id":…,"data":…}
/// {"op":"error","id":…,"error":{…}}; `error` is what error_text made.
std::string stream_error_text(const std::string& id, const std::string& error);
std::string news_text(Topic topic, const std::string& data);  ///< {"op":"message","topic":…,"data":…}

}  // namespace kinemap
