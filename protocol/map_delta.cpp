// SPDX-License-Identifier: Apache-2.0
#include "protocol/map_delta.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

/// The things of `list` with those of `changed` put in and `removed` left out, by ascending id.
Json merged(const Json& list, const Json& changed, const Json& removed) {
  std::map<std::uint64_t, const Json*> things;
  for (const Json& thing : list) things[thing.at("id").get<std::uint64_t>()] = &thing;
  for (const Json& id : removed) things.erase(id.get<std::uint64_t>());
  for (const Json& thing : changed) things[thing.at("id").get<std::uint64_t>()] = &thing;
  Json out = Json::array();
  for (const auto& [id, thing] : things) out.push_back(*thing);
  return out;
}

}  // namespace

std::optional<Error> apply_map_message(const Json& message, Json& map) {
  if (!message.contains("since")) {
    map = message;
    map.erase("note");
    return std::nullopt;
  }
  if (map.value("revision", Json()) != message.at("since") || map.value("run", "") != message.at("run"))
    return Error{"a change since revision " + message.at("since").dump() + ", which is not the one that is here"};
  Json next = map;
  for (const auto& [key, value] : message.items()) {
    if (key == "since" || key == "removed") continue;
    next[key] = key == "objects" || key == "rooms" ? merged(map.at(key), value, message.at("removed").at(key)) : value;
  }
  map = std::move(next);
  return std::nullopt;
}

}  // namespace kinemap
