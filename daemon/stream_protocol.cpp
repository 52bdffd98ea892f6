// SPDX-License-Identifier: Apache-2.0
#include "daemon/stream_protocol.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "daemon/json_params.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Topic> kAllTopics{Topic::Map, Topic::Pose, Topic::Body, Topic::Status, Topic::Events};

BadMessage bad(const std::string& message, const std::string& id = {}) { return {id, {400, "bad_message", message}}; }

std::optional<Topic> topic_from(const Json& json) {
  if (!json.is_string()) return std::nullopt;
  const auto& name = json.get_ref<const std::string&>();
  const auto it = std::find(kTopicNames.begin(), kTopicNames.end(), name);
  if (it == kTopicNames.end()) return std::nullopt;
  return static_cast<Topic>(it - kTopicNames.begin());
}

/// nullopt when "topics" is there but is no list of known topics, or is missing where it must not.
std::optional<std::vector<Topic>> topics_of(const Json& message, bool all_by_default) {
  const auto it = message.find("topics");
  if (it == message.end()) return all_by_default ? std::optional(kAllTopics) : std::nullopt;
  if (!it->is_array()) return std::nullopt;
  std::vector<Topic> topics;
  for (const auto& item : *it) {
    const auto topic = topic_from(item);
    if (!topic) return std::nullopt;
    topics.push_back(*topic);
  }
  return topics;
}

ClientMessage query_of(const Json& message) {
  const auto id_it = message.find("id");
  if (id_it == message.end() || !(id_it->is_number() || id_it->is_string()))
    return bad("a query needs an \"id\", a number or a string, which comes back with the answer");
  std::string id = id_it->dump();
  if (id.size() > 200) return bad("the query's id is longer than 200 bytes");
  const auto path = message.find("path");
  if (path == message.end() || !path->is_string())
    return bad("a query needs a \"path\", such as map, objects or objects/7; openapi.json has all", id);
  StreamQuery query{std::move(id), path->get<std::string>(), {}};
  const auto params = message.find("params");
  if (params == message.end()) return query;
  if (!params->is_object()) return bad("\"params\" must be an object", query.id);
  auto values = params_from_json(*params);
  if (!values) return bad(values.error(), query.id);
  query.params = std::move(*values);
  return query;
}

std::string shown(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40);
}

ClientMessage subscribe_of(const Json& message, std::vector<Topic> topics) {
  Subscribe subscribe{std::move(topics), {}, {}};
  if (const auto rate = message.find("rate_hz"); rate != message.end()) {
    subscribe.rate_hz = rate->is_number() ? rate->get<double>() : 0.0;
    if (!(*subscribe.rate_hz >= kSlowestHz && *subscribe.rate_hz <= kFastestHz))
      return bad("\"rate_hz\" must be a number from 0.1 to 240, not " + shown(*rate));
  }
  const auto since = message.find("since"), run = message.find("run");
  if (since != message.end()) {
    if (!since->is_number_unsigned())
      return bad("\"since\" must be the revision of the map that you have, not " + shown(*since));
    subscribe.known = KnownMap{since->get<std::uint64_t>(), ""};
  }
  if (run != message.end()) {
    if (!run->is_string() || !subscribe.known) return bad("\"run\" must be the map's run, a string, beside \"since\"");
    subscribe.known->run = run->get<std::string>();
  }
  return subscribe;
}

}  // namespace

ClientMessage parse_client_message(std::string_view text) {
  const Json message = parse_message(text);
  if (message.is_discarded() || !message.is_object()) return bad("a message is a JSON object with \"op\"");
  const auto op_it = message.find("op");
  const std::string op = op_it != message.end() && op_it->is_string() ? op_it->get<std::string>() : std::string();
  constexpr const char* kTopics = "\"topics\" must be a list of: map, pose, body, status, events";
  if (op == "subscribe") {
    auto topics = topics_of(message, false);
    return topics ? subscribe_of(message, std::move(*topics)) : bad(kTopics);
  }
  if (op == "unsubscribe") {
    auto topics = topics_of(message, true);
    return topics ? ClientMessage(Unsubscribe{std::move(*topics)}) : bad(kTopics);
  }
  if (op == "query") return query_of(message);
  return bad("\"op\" must be subscribe, unsubscribe or query");
}

std::string subscribed_text(const std::vector<Topic>& topics, const std::vector<std::pair<Topic, double>>& rates_hz) {
  const auto name = [](Topic topic) { return kTopicNames[static_cast<std::size_t>(topic)]; };
  Json names = Json::array(), rates = Json::object();
  for (const Topic topic : topics) names.push_back(name(topic));
  for (const auto& [topic, hz] : rates_hz) rates[name(topic)] = hz;
  return Json{{"op", "subscribed"}, {"topics", std::move(names)}, {"rate_hz", std::move(rates)}}.dump();
}

std::string result_text(const std::string& id, const std::string& data) {
  return R"({"op":"result","id":)" + id + R"(,"data":)" + data + "}";
}

std::string stream_error_text(const std::string& id, const std::string& error) {
  const std::string members = error.substr(1);  // of {"error":{…}}
  return R"({"op":"error",)" + (id.empty() ? std::string() : "\"id\":" + id + ",") + members;
}

std::string news_text(Topic topic, const std::string& data) {
  return std::string(R"({"op":"message","topic":")") + kTopicNames[static_cast<std::size_t>(topic)] + R"(","data":)" +
         data + "}";
}

}  // namespace kinemap
