// SPDX-License-Identifier: Apache-2.0
#include "daemon/foxglove_feed.hpp"

#include <algorithm>
#include <utility>

#include "protocol/foxglove/floor.hpp"
#include "protocol/foxglove/messages.hpp"

namespace kinemap::foxglove {
namespace {

constexpr std::chrono::milliseconds kTransformsPeriod{33};
constexpr std::chrono::milliseconds kTick{11};  // a third of it, so that the timer's lateness does not halve the rate
constexpr std::chrono::milliseconds kIdleTick{50};
constexpr std::chrono::seconds kStatePeriod{1};  // trajectory and floor are long
constexpr std::size_t kMostPoses = 2000;         // of the trajectory: 200 kB

SharedText shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

Feed::Feed(Api& api) : api_(api), services_(api) {}

std::chrono::milliseconds Feed::period() const { return listeners_.empty() ? kIdleTick : kTick; }

void Feed::tick(TimePoint now) {
  std::vector<std::shared_ptr<Listener>> everyone;
  for (const auto& weak : listeners_)
    if (auto listener = weak.lock()) everyone.push_back(std::move(listener));
  std::erase_if(listeners_, [](const auto& weak) { return weak.expired(); });
  for (const Channel channel : kChannels) {
    auto& anyone = wanted_[static_cast<std::size_t>(channel)];
    anyone = std::any_of(everyone.begin(), everyone.end(), [&](const auto& l) { return l->wants(channel); });
    if (!anyone) at(channel).text.reset();
  }
  const auto map = api_.sources().map();
  update_log();
  if (everyone.empty()) return;
  const LiveBody body = api_.sources().body();
  time_ns_ = nanoseconds(body.known ? body.time_s : map->time_s);
  update_transforms(*map, body, now);
  update_scene(*map);
  update_state(*map, now);
  for (const auto& listener : everyone) listener->wake(now);
}

void Feed::publish(Message message) {
  Newest& newest = at(message.channel);
  newest = {newest.version + 1, time_ns_, shared(std::move(message.json))};
}

void Feed::update_transforms(const MapSnapshot& map, const LiveBody& body, TimePoint now) {
  if (!wanted(Channel::Transforms)) return;
  const bool same = body.time_s == transforms_time_s_ && map.revision == transforms_revision_;
  if (at(Channel::Transforms).text && (same || now < transforms_due_)) return;
  std::array<Pose, kSegmentCount> segments;
  for (std::size_t i = 0; i < kSegmentCount; ++i) segments[i] = body.T_odom(static_cast<Segment>(i));
  publish(transforms(body.time_s, map.T_map_odom, {segments.data(), body.known ? kSegmentCount : 0}));
  transforms_time_s_ = body.time_s;
  transforms_revision_ = map.revision;
  transforms_due_ = std::max(transforms_due_ + kTransformsPeriod, now);
}

void Feed::update_scene(const MapSnapshot& map) {
  const bool fresh = !at(Channel::Scene).text;  // nobody wanted it until now
  if (!wanted(Channel::Scene) || (!fresh && map.revision == scene_revision_)) return;
  scene_revision_ = map.revision;
  auto change = scene_.update(map);
  if (!change && !fresh) return;
  scene_changed_ = change && !fresh;
  whole_scene_.reset();
  publish(scene_changed_ ? std::move(*change) : scene_.whole());
}

SharedText Feed::scene_since(std::uint64_t version) {
  const Newest& newest = at(Channel::Scene);
  if (!scene_changed_ || version + 1 == newest.version) return newest.text;
  if (!whole_scene_) whole_scene_ = shared(scene_.whole().json);
  return whole_scene_;
}

void Feed::update_state(const MapSnapshot& map, TimePoint now) {
  const bool newer = map.revision != state_revision_ && now >= state_due_;
  for (const Channel channel : {Channel::Trajectory, Channel::Floor}) {
    if (!wanted(channel) || (at(channel).text && !newer)) continue;
    publish(channel == Channel::Trajectory ? trajectory(map, kMostPoses) : floor(map));
  }
  if (!newer) return;
  state_revision_ = map.revision;
  state_due_ = now + kStatePeriod;
}

void Feed::update_log() {
  const std::uint64_t seen = log_.empty() ? 0 : log_.back().version;
  for (const LiveEvent& event : api_.events().all()) {
    if (event.number <= seen) continue;
    Message message = log(event.time_s, event.kind == "suit_lost" ? LogLevel::Warning : LogLevel::Info, event.message);
    log_.push_back({event.number, message.time_ns, shared(std::move(message.json))});
    if (log_.size() > LiveEvents::kKept) log_.pop_front();
  }
}

const Newest* Feed::log_after(std::uint64_t version) const {
  const auto it = std::find_if(log_.begin(), log_.end(), [=](const Newest& entry) { return entry.version > version; });
  return it == log_.end() ? nullptr : &*it;
}

}  // namespace kinemap::foxglove
