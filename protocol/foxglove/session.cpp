// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/session.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "protocol/foxglove/floor.hpp"
#include "protocol/foxglove/messages.hpp"

namespace kinemap::foxglove {
namespace {

constexpr double kStatePeriod = 5.0;      // s: of trajectory and floor, which are long
constexpr std::size_t kMostPoses = 2000;  // of a trajectory that is written again and again

mcap::Writer writer(mcap::Writer::Sink sink) {
  std::vector<mcap::Channel> channels;
  for (const Channel channel : kChannels)
    channels.push_back({topic(channel), "json", schema_name(channel), "jsonschema", schema_text(channel)});
  return {std::move(sink), "kinemap", std::move(channels)};
}

void put(mcap::Writer& writer, const Message& message) {
  writer.write(static_cast<std::size_t>(message.channel), message.time_ns, message.json);
}

/// At another time than the map's.
Message at(double time_s, Message message) {
  message.time_ns = nanoseconds(time_s);
  return message;
}

using Objects = std::map<std::uint32_t, const MapObject*>;

Objects by_id(const MapSnapshot& map) {
  Objects objects;
  for (const MapObject& object : map.objects) objects.emplace(object.id, &object);
  return objects;
}

std::string name_of(const MapObject& object) {
  return std::string(to_string(object.type)) + " " + std::to_string(object.id);
}

/// Objects found and gone, loops closed and opened again, from one revision to the next.
std::vector<Message> log_of_changes(const MapSnapshot& before, const MapSnapshot& after) {
  const Objects old = by_id(before), now = by_id(after);
  std::vector<Message> list;
  const auto add = [&](const std::string& text) { list.push_back(log(after.time_s, LogLevel::Info, text)); };
  for (const auto& [id, object] : now)
    if (!old.contains(id)) add(name_of(*object) + " found");
  for (const auto& [id, object] : old)
    if (!now.contains(id)) add(name_of(*object) + " has gone: it was part of another, or could not be held");
  if (after.graph.loop_closures > before.graph.loop_closures)
    add("loop closed, " + std::to_string(after.graph.loop_closures) + " so far");
  if (after.graph.loop_closures_revoked > before.graph.loop_closures_revoked)
    add("loop closure taken back, " + std::to_string(after.graph.loop_closures_revoked) + " so far");
  return list;
}

std::vector<Message> visits(const MapObject& object) {
  std::vector<Message> list;
  for (const Visit& visit : object.visits)
    list.push_back(log(visit.begin_s, LogLevel::Info,
                       (object.type == ObjectType::Chair ? "sat on " : "traced ") + name_of(object)));
  return list;
}

}  // namespace

SessionRecorder::SessionRecorder(mcap::Writer::Sink sink, double transforms_hz)
    : writer_(writer(std::move(sink))), period_s_(1.0 / transforms_hz) {}

void SessionRecorder::write(const Message& message) { put(writer_, message); }

void SessionRecorder::add(const SuitFrame& frame, const MapSnapshot& map) {
  take(map);
  if (frame.time_s >= state_due_s_) {
    take_state(map);
    state_due_s_ = frame.time_s + kStatePeriod;
  }
  if (frame.time_s < transforms_due_s_) return;
  write(transforms(frame.time_s, map.T_map_odom, frame.segments));
  transforms_due_s_ = std::max(transforms_due_s_ + period_s_, frame.time_s);
}

void SessionRecorder::finish(const MapSnapshot& map) {
  take(map);
  write(trajectory(map));
  write(floor(map));
  writer_.finish();
}

/// Objects and events, when the map is another one than the last.
void SessionRecorder::take(const MapSnapshot& map) {
  if (map_ && map_->revision == map.revision) return;
  if (const auto update = scene_.update(map)) write(*update);
  for (const Message& message : log_of_changes(map_.value_or(MapSnapshot{}), map)) write(message);
  map_ = MapSnapshot{};
  map_->revision = map.revision;
  map_->objects = map.objects;
  map_->graph = map.graph;
}

void SessionRecorder::take_state(const MapSnapshot& map) {
  if (map.trajectory.empty()) return;
  write(trajectory(map, kMostPoses));
  write(floor(map));
}

std::string mcap_bytes(const MapSnapshot& map) {
  std::vector<Message> messages;
  const double begin_s = map.trajectory.empty() ? 0.0 : map.trajectory.front().time_s;
  messages.push_back(at(begin_s, trajectory(map)));
  messages.push_back(at(begin_s, floor(map)));
  for (const TrajectoryPose& pose : map.trajectory)
    messages.push_back(
        transforms(pose.time_s, pose.T_map_pelvis * pose.T_odom_pelvis.inverse(), {&pose.T_odom_pelvis, 1}));
  for (const Entity& entity : entities(map)) messages.push_back(scene(entity.time_s, {&entity, 1}));
  for (const MapObject& object : map.objects)
    for (Message& message : visits(object)) messages.push_back(std::move(message));
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.time_ns < b.time_ns; });
  std::string bytes;
  mcap::Writer file = writer([&bytes](std::string_view part) { bytes += part; });
  for (const Message& message : messages) put(file, message);
  file.finish();
  return bytes;
}

}  // namespace kinemap::foxglove
