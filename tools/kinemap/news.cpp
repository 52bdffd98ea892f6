// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/news.hpp"

#include "protocol/map_delta.hpp"
#include "protocol/map_json.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMovedM = 0.02;  ///< smaller shifts are the optimiser's everyday work

std::string describe(const MapObject& object) {
  std::string text = format("%s %u", to_string(object.type), object.id);
  if (object.size) text += format("  %.2f × %.2f m", (*object.size)[0], (*object.size)[1]);
  return text + format("  at (%.2f, %.2f, %.2f)", object.pose.p.x(), object.pose.p.y(), object.pose.p.z());
}

double change(const MapObject& a, const MapObject& b) {
  double most = (a.pose.p - b.pose.p).norm();
  if (a.size && b.size)
    for (std::size_t i = 0; i < 2; ++i) most = std::max(most, std::abs((*a.size)[i] - (*b.size)[i]));
  return most;
}

double number(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_number() ? json[key].get<double>() : 0.0;
}

std::string event_line(const Json& data) {
  const std::string when = format("%.1f–%.1f s  ", number(data, "begin"), number(data, "end"));
  const std::string kind = data.value("event", "");
  if (kind == "trace") return when + format("trace, %.0f contacts\n", number(data, "contacts"));
  if (kind == "sitting") return when + format("sat down, seat %.2f m high\n", number(data, "seat_height"));
  return format("%.1f s  ", number(data, "time")) + data.value("message", kind) + '\n';
}

std::string pose_line(const Json& data) {
  if (!data.contains("position") || !data["position"].is_array() || data["position"].size() != 3) return "";
  const Json& p = data["position"];
  return format("%.2f s  pelvis at (%.2f, %.2f, %.2f)\n", number(data, "time"), p[0].get<double>(), p[1].get<double>(),
                p[2].get<double>());
}

std::string status_line(const Json& data) {
  const Json suit = data.value("suit", Json::object());
  const Json stream = suit.value("stream", Json::object());
  return format("status: %s, %.0f frames, %.0f lost\n", suit.value("receiving", false) ? "receiving" : "no suit",
                number(stream, "frames"), number(stream, "lost_samples"));
}

}  // namespace

std::string News::map_lines(const MapSnapshot& map) {
  std::string text;
  std::map<std::uint32_t, MapObject> now;
  for (const MapObject& object : map.objects) {
    const auto before = known_.find(object.id);
    if (before == known_.end())
      text += "  + " + describe(object) + '\n';
    else if (const double moved = change(before->second, object); moved >= kMovedM)
      text += "  ~ " + describe(object) + format("  (by %.2f m)\n", moved);
    now.emplace(object.id, object);
  }
  for (const auto& [id, object] : known_)
    if (!now.contains(id)) text += format("  - %s %u\n", to_string(object.type), id);
  known_ = std::move(now);
  return format("revision %llu at %.1f s: %zu object%s\n", static_cast<unsigned long long>(map.revision), map.time_s,
                map.objects.size(), map.objects.size() == 1 ? "" : "s") +
         text;
}

std::string News::lines(const std::string& message) {
  try {
    const Json json = Json::parse(message);
    if (json.value("op", "") == "error") return "error: " + json.at("error").value("message", message) + '\n';
    if (json.value("op", "") != "message") return "";
    const std::string topic = json.value("topic", "");
    const Json& data = json.at("data");
    if (topic == "events") return event_line(data);
    if (topic == "pose") return pose_line(data);
    if (topic == "status") return status_line(data);
    if (topic != "map") return "";
    if (const auto error = apply_map_message(data, map_)) return "map: " + error->message + '\n';
    const auto map = map_from_text(map_.dump());
    return map ? map_lines(*map) : "map: " + map.error() + '\n';
  } catch (const Json::exception& error) {
    return std::string("a message that cannot be read: ") + error.what() + '\n';
  }
}

}  // namespace kinemap::cli
