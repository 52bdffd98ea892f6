// SPDX-License-Identifier: Apache-2.0
#include "daemon/live_events.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMovedM = 0.02;  ///< smaller shifts are the optimiser's everyday work

std::string name_of(ObjectType type, std::uint32_t id) {
  return std::string(to_string(type)) + " " + std::to_string(id);
}

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f m", value);
  return text;
}

std::string names_of(const std::vector<std::uint32_t>& ids) {
  std::string text;
  for (const auto id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
  return text;
}

class EventMaker {
 public:
  EventMaker(std::deque<LiveEvent>& events, std::uint64_t& count) : events_(events), count_(count) {}

  void make(const char* kind, double time_s, const std::string& message, const Json& details) {
    Json json = {{"number", ++count_}, {"event", kind}, {"time", rounded(time_s)}, {"message", message}};
    json.update(details);
    events_.push_back({count_, kind, time_s, message, std::make_shared<const std::string>(json.dump())});
    if (events_.size() > LiveEvents::kKept) events_.pop_front();
  }

 private:
  std::deque<LiveEvent>& events_;
  std::uint64_t& count_;
};

double largest_change(const MapObject& now, const Eigen::Vector3d& p,
                      const std::optional<std::array<double, 2>>& size) {
  double most = (now.pose.p - p).norm();
  if (now.size && size)
    for (std::size_t i = 0; i < 2; ++i) most = std::max(most, std::abs((*now.size)[i] - (*size)[i]));
  return most;
}

}  // namespace

void LiveEvents::add(const Notice& notice) {
  EventMaker events(events_, count_);
  Json details = {{"begin", rounded(notice.begin_s)}, {"end", rounded(notice.end_s)}};
  if (notice.kind == Notice::Kind::Trace) {
    details["contacts"] = notice.contacts;
    events.make("trace", notice.end_s, "traced something, " + std::to_string(notice.contacts) + " contacts", details);
  } else {
    details["seat_height"] = rounded(notice.seat_height_m);
    events.make("sitting", notice.end_s, "sat, " + metres(notice.seat_height_m) + " high", details);
  }
}

void LiveEvents::look(const State& state) {
  EventMaker events(events_, count_);
  if (state.receiving != receiving_)
    events.make(state.receiving ? "suit_back" : "suit_lost", state.time_s,
                state.receiving ? "the suit sends" : "the suit has fallen silent", Json::object());
  receiving_ = state.receiving;
  if (state.tracing && !tracing_)
    events.make("gesture_began", state.time_s, "the hand begins to trace something", Json::object());
  tracing_ = state.tracing;
  if (state.map != map_) {
    compare_maps(*state.map, state.time_s);
    map_ = state.map;
  }
}

void LiveEvents::compare_maps(const MapSnapshot& map, double time_s) {
  EventMaker events(events_, count_);
  std::vector<std::uint32_t> seen_again;
  std::map<std::uint32_t, Seen> now;
  for (const MapObject& object : map.objects) {
    const std::string name = name_of(object.type, object.id);
    const Json details = {{"object", object.id}, {"type", to_string(object.type)}, {"revision", map.revision}};
    Seen seen{object.type, object.pose.p, object.size, object.observations};
    const auto before = announced_.find(object.id);
    if (before == announced_.end()) {
      events.make("object_found", time_s, name + " found", details);
    } else {
      if (object.observations > before->second.observations) seen_again.push_back(object.id);
      const double change = largest_change(object, before->second.p, before->second.size);
      if (change >= kMovedM) {
        Json changed = details;
        changed["by"] = rounded(change);
        events.make("object_changed", time_s, name + " changed by " + metres(change), changed);
      } else {  // many small shifts shall not go unsaid: they are held against what was announced
        seen.p = before->second.p;
        seen.size = before->second.size;
      }
    }
    now.emplace(object.id, seen);
  }
  for (const auto& [id, seen] : announced_)
    if (!now.contains(id))
      events.make("object_removed", time_s, name_of(seen.type, id) + " removed",
                  {{"object", id}, {"type", to_string(seen.type)}, {"revision", map.revision}});
  announced_ = std::move(now);
  if (map_) compare_closures(map, seen_again, time_s);
}

void LiveEvents::compare_closures(const MapSnapshot& map, const std::vector<std::uint32_t>& seen_again, double time_s) {
  EventMaker events(events_, count_);
  const auto details = [&](std::size_t count) {
    return Json{{"objects", seen_again}, {"count", count}, {"revision", map.revision}};
  };
  const std::string again = seen_again.empty() ? "" : ": seen again " + names_of(seen_again);
  if (map.graph.loop_closures > map_->graph.loop_closures)
    events.make("loop_closed", time_s, "loop closed" + again, details(map.graph.loop_closures));
  if (map.graph.loop_closures_revoked > map_->graph.loop_closures_revoked)
    events.make("loop_revoked", time_s, "a loop closure was taken back", details(map.graph.loop_closures_revoked));
}

}  // namespace kinemap
