// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/scene.hpp"

#include <utility>

#include "protocol/foxglove/json.hpp"

namespace kinemap::foxglove {
namespace {

enum class Deletion { MatchingId, All };

Json deletion(double time_s, Deletion type, const std::string& id) {
  return {{"timestamp", time_json(time_s)}, {"type", static_cast<int>(type)}, {"id", id}};
}

/// `entities` is a list of JSON texts, with commas.
Message message(double time_s, const Json& deletions, const std::string& entities) {
  return {Channel::Scene, nanoseconds(time_s),
          "{\"deletions\":" + text_of(deletions) + ",\"entities\":[" + entities + "]}"};
}

void append(std::string& list, const std::string& item) { list += (list.empty() ? "" : ",") + item; }

}  // namespace

Message scene(double time_s, std::span<const Entity> entities) {
  std::string list;
  for (const Entity& entity : entities) append(list, entity.json);
  return message(time_s, Json::array(), list);
}

std::optional<Message> Scene::update(const MapSnapshot& map) {
  time_s_ = map.time_s;
  std::map<std::string, std::string> now;
  std::string changed;
  for (Entity& entity : entities(map)) {
    const auto before = entities_.find(entity.id);
    if (before == entities_.end() || before->second != entity.json) append(changed, entity.json);
    now.emplace(std::move(entity.id), std::move(entity.json));
  }
  Json deletions = Json::array();
  for (const auto& [id, json] : entities_)
    if (!now.contains(id)) deletions.push_back(deletion(time_s_, Deletion::MatchingId, id));
  entities_ = std::move(now);
  if (changed.empty() && deletions.empty()) return std::nullopt;
  return message(time_s_, deletions, changed);
}

Message Scene::whole() const {
  std::string all;
  for (const auto& [id, json] : entities_) append(all, json);
  return message(time_s_, Json::array({deletion(time_s_, Deletion::All, "")}), all);
}

}  // namespace kinemap::foxglove
