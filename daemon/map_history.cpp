// SPDX-License-Identifier: Apache-2.0
#include "daemon/map_history.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/json_text.hpp"
#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kCachedDeltas = 32;  // clients are mostly one or two revisions behind

/// `json` with `items` put in after the key `key`.
Json with_after(const Json& json, const char* key, const Json& items) {
  Json out;
  for (const auto& [name, value] : json.items()) {
    out[name] = value;
    if (name == key) out.update(items);
  }
  return out;
}

}  // namespace

void MapHistory::bury(Kind kind, std::uint32_t id) {
  tombstones_.push_back({kind, id, map_->revision});
  if (tombstones_.size() <= kTombstones) return;
  oldest_ = tombstones_.front().revision;
  tombstones_.pop_front();
}

template <class List>
void MapHistory::note(const List& list, Kind kind, Items& items) {
  Items now;
  for (const auto& thing : list) {
    Item item{compact_text(to_json(thing)), map_->revision};
    const auto before = items.find(thing.id);
    if (before != items.end() && before->second.text == item.text) item.changed = before->second.changed;
    now.insert_or_assign(thing.id, std::move(item));
  }
  for (const auto& [id, item] : items)
    if (!now.contains(id)) bury(kind, id);
  items = std::move(now);
}

void MapHistory::update(std::shared_ptr<const MapSnapshot> map) {
  if (map == map_) return;
  if (!map_) oldest_ = map->revision;
  map_ = std::move(map);
  whole_.reset();
  deltas_.clear();
  note(map_->objects, Kind::Object, objects_);
  note(map_->rooms, Kind::Room, rooms_);
  MapSnapshot lists;
  lists.doorways = map_->doorways;
  lists.unresolved = map_->unresolved;
  const Json json = to_json(lists);
  for (auto [item, name] : {std::pair(&doorways_, "doorways"), std::pair(&unresolved_, "unresolved")}) {
    std::string text = compact_text(json.at(name));
    if (text != item->text) *item = {std::move(text), map_->revision};
  }
}

SharedText MapHistory::whole() {
  if (!whole_)
    whole_ = std::make_shared<const std::string>(compact_text(with_after(to_json(*map_), "revision", {{"run", run_}})));
  return whole_;
}

std::optional<std::string> MapHistory::unknown(const KnownMap& known) const {
  const std::string revision = "revision " + std::to_string(known.revision);
  if (!known.run.empty() && known.run != run_) return revision + " is of another run of the daemon";
  if (known.revision > map_->revision) return revision + " is newer than the map, the daemon has been restarted";
  if (known.revision < oldest_)
    return revision + " is too old, what was removed is known since " + std::to_string(oldest_);
  return std::nullopt;
}

SharedText MapHistory::since(const KnownMap& known) {
  if (const auto why = unknown(known)) {
    const Json extra = {{"run", run_}, {"note", "the whole map: " + *why}};
    return std::make_shared<const std::string>(compact_text(with_after(to_json(*map_), "revision", extra)));
  }
  const auto cached = deltas_.find(known.revision);
  if (cached != deltas_.end()) return cached->second;
  auto text = std::make_shared<const std::string>(delta_text(known.revision));
  if (deltas_.size() < kCachedDeltas) deltas_.emplace(known.revision, text);
  return text;
}

std::string MapHistory::delta_text(std::uint64_t revision) const {
  // A map with only what changed, so that it is written as a map is.
  MapSnapshot changed;
  changed.revision = map_->revision;
  changed.time_s = map_->time_s;
  for (const MapObject& object : map_->objects)
    if (objects_.at(object.id).changed > revision) changed.objects.push_back(object);
  for (const Room& room : map_->rooms)
    if (rooms_.at(room.id).changed > revision) changed.rooms.push_back(room);
  changed.doorways = map_->doorways;
  changed.unresolved = map_->unresolved;
  changed.T_map_odom = map_->T_map_odom;
  changed.hand = map_->hand;
  changed.wearers = map_->wearers;
  changed.graph = map_->graph;

  Json json = with_after(to_json(changed), "revision", {{"run", run_}, {"since", revision}});
  Json removed = {{"objects", Json::array()}, {"rooms", Json::array()}};
  for (const Tombstone& stone : tombstones_) {
    const bool object = stone.kind == Kind::Object;
    if (stone.revision <= revision || (object ? objects_ : rooms_).contains(stone.id)) continue;
    removed[object ? "objects" : "rooms"].push_back(stone.id);
  }
  json = with_after(json, "rooms", {{"removed", std::move(removed)}});
  if (doorways_.changed <= revision) json.erase("doorways");
  if (unresolved_.changed <= revision) json.erase("unresolved");
  return compact_text(json);
}

}  // namespace kinemap
