// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/object_table.hpp"

#include <algorithm>
#include <numbers>

#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

std::string size_text(const MapObject& object) {
  if (!object.size) return "";
  return format("%s%.2f × %.2f%s", object.open_ended() ? "≥ " : "", (*object.size)[0], (*object.size)[1],
                object.height_assumed ? "*" : "");
}

std::string heading_text(const MapObject& object) {
  const bool faces = object.plane && object.type != ObjectType::Table;
  const double heading =
      faces ? std::atan2(object.plane->normal.y(), object.plane->normal.x()) : heading_of(object.pose.q);
  return format("%.0f", heading * 180.0 / std::numbers::pi);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string object_table(std::span<const MapObject> objects, std::span<const double> distances) {
  if (objects.empty()) return "";
  const bool far = distances.size() == objects.size();
  std::vector<std::vector<std::string>> rows = {
      {"id", "type", "size m", "x", "y", "z", "heading°", "±m", "seen", "for"}};
  if (far) rows[0].push_back("distance m");
  bool assumed = false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const MapObject& object = objects[i];
    const Eigen::Vector3d& p = object.pose.p;
    const double sigma = object.sigma.position_m;
    rows.push_back({std::to_string(object.id), to_string(object.type), size_text(object), format("%.2f", p.x()),
                    format("%.2f", p.y()), format("%.2f", p.z()), heading_text(object),
                    sigma > 0.0 ? format("%.2f", sigma) : "", std::to_string(object.observations),
                    joined(object.functions)});
    if (far) rows.back().push_back(format("%.2f", distances[i]));
    assumed = assumed || object.height_assumed;
  }
  std::string text = text_table(rows, {1, 9});
  if (assumed) text += "* height assumed, not observed\n";
  return text;
}

std::string object_counts(const MapSnapshot& map) {
  std::string text = format("%zu object%s", map.objects.size(), map.objects.size() == 1 ? "" : "s");
  const char* separator = ": ";
  for (const ObjectType type : {ObjectType::Wall, ObjectType::Table, ObjectType::Screen, ObjectType::Chair}) {
    const auto n = std::count_if(map.objects.begin(), map.objects.end(),
                                 [type](const MapObject& object) { return object.type == type; });
    if (n == 0) continue;
    text += format("%s%td %s%s", separator, n, to_string(type), n == 1 ? "" : "s");
    separator = ", ";
  }
  for (const Room& room : map.rooms) text += format("; room %u of %.1f m²", room.id, room.area_m2);
  return text;
}

}  // namespace kinemap::cli
