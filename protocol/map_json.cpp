// SPDX-License-Identifier: Apache-2.0
#include "protocol/map_json.hpp"

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

template <class Vector>
Json array_of(const Vector& values) {
  Json array = Json::array();
  for (Eigen::Index i = 0; i < values.size(); ++i) array.push_back(rounded(values[i]));
  return array;
}

Json array_of(const std::array<double, 2>& values) { return {rounded(values[0]), rounded(values[1])}; }

/// Sigmas that are unknown (0, or not finite) are left out, as everything unknown is.
Json sigma_json(const MapObject& object) {
  const auto known = [](double sigma) { return std::isfinite(sigma) && sigma > 0.0; };
  const ObjectSigma& sigma = object.sigma;
  Json json = Json::object();
  if (known(sigma.position_m)) json["position"] = rounded(sigma.position_m);
  if (known(sigma.heading_rad)) json["heading"] = rounded(sigma.heading_rad);
  for (const double side : sigma.size_m) {
    if (!object.size || !known(side)) break;
    json["size"].push_back(rounded(side));
  }
  return json;
}

Json hand_json(const TouchingHand& hand) {
  Json json = {{"part", to_string(hand.part)},
               {"probability", rounded(hand.probability)},
               {"touch_point", array_of(hand.p_hand)}};
  if (hand.sigma_m.allFinite() && hand.sigma_m.minCoeff() > 0.0) json["sigma"] = array_of(hand.sigma_m);
  return json;
}

Json graph_json(const GraphSummary& graph) {
  return {{"key_poses", graph.key_poses},
          {"landmarks", graph.landmarks},
          {"contacts", graph.contacts},
          {"loop_closures", graph.loop_closures},
          {"loop_closures_revoked", graph.loop_closures_revoked},
          {"optimisations", graph.optimisations},
          {"optimisations_failed", graph.optimisations_failed},
          {"last_cost", rounded(graph.last_cost)}};
}

template <class List>
Json list_json(const List& list) {
  Json array = Json::array();
  for (const auto& item : list) array.push_back(to_json(item));
  return array;
}

}  // namespace

double rounded(double value) {
  assert(std::isfinite(value));
  return std::round(value * 1e6) / 1e6 + 0.0;
}

Json to_json(const Pose& pose) {
  // q and −q are one rotation; w ≥ 0 makes equal maps equal bytes.
  const double sign = pose.q.w() < 0.0 ? -1.0 : 1.0;
  return {{"position", array_of(pose.p)},
          {"orientation", Json::array({rounded(sign * pose.q.w()), rounded(sign * pose.q.x()),
                                       rounded(sign * pose.q.y()), rounded(sign * pose.q.z())})}};
}

Json to_json(const MapObject& object) {
  Json json = {{"id", object.id}, {"type", to_string(object.type)}, {"functions", object.functions}};
  json["pose"] = to_json(object.pose);
  if (object.plane)
    json["plane"] = {{"normal", array_of(object.plane->normal)}, {"offset", rounded(object.plane->offset)}};
  if (object.corners) {
    Json& corners = json["corners"] = Json::array();
    for (const Eigen::Vector3d& corner : *object.corners) corners.push_back(array_of(corner));
  }
  if (object.size) json["size"] = array_of(*object.size);
  if (object.height_assumed) json["height_assumed"] = true;
  if (object.ends) json["ends"] = {to_string((*object.ends)[0]), to_string((*object.ends)[1])};
  if (Json sigma = sigma_json(object); !sigma.empty()) json["sigma"] = std::move(sigma);
  json["observations"] = object.observations;
  json["first_seen"] = rounded(object.first_seen_s);
  json["last_seen"] = rounded(object.last_seen_s);
  for (const Visit& visit : object.visits) json["visits"].push_back({rounded(visit.begin_s), rounded(visit.end_s)});
  return json;
}

Json to_json(const Room& room) {
  Json json = {{"id", room.id}, {"polygon", Json::array()}};
  for (const Eigen::Vector2d& corner : room.polygon) json["polygon"].push_back(array_of(corner));
  json["area"] = rounded(room.area_m2);
  json["height"] = rounded(room.height_m);
  if (room.height_assumed) json["height_assumed"] = true;
  json["walls"] = Json::array();
  for (const std::uint32_t id : room.wall_ids) json["walls"].push_back(id);
  if (!room.inferred_sides.empty()) json["inferred_sides"] = room.inferred_sides;
  return json;
}

Json to_json(const Doorway& doorway) {
  return {
      {"position", array_of(doorway.position)}, {"heading", rounded(doorway.heading_rad)}, {"rooms", doorway.room_ids}};
}

Json to_json(const MapWearer& wearer) {
  Json json = Json::object();
  if (!wearer.name.empty()) json["name"] = wearer.name;
  if (wearer.stature_m) json["stature"] = rounded(*wearer.stature_m);
  json["hand"] = hand_json(wearer.hand);
  return json;
}

Json to_json(const MapSnapshot& map) {
  Json json = {{"format", "kinemap/map"},
               {"version", kVersion},
               {"revision", map.revision},
               {"time", rounded(map.time_s)},
               {"frame", {{"id", "map"}, {"up", "+z"}, {"units", "m"}}}};
  json["objects"] = list_json(map.objects);
  json["rooms"] = list_json(map.rooms);
  json["doorways"] = list_json(map.doorways);
  Json& unresolved = json["unresolved"] = Json::array();
  for (const UnresolvedTrace& trace : map.unresolved)
    unresolved.push_back({{"begin", rounded(trace.begin_s)}, {"end", rounded(trace.end_s)}, {"reason", trace.reason}});
  json["correction"] = to_json(map.T_map_odom);
  if (map.hand) json["hand"] = hand_json(*map.hand);
  if (!map.wearers.empty()) json["wearers"] = list_json(map.wearers);
  json["graph"] = graph_json(map.graph);
  return json;
}

std::string map_text(const MapSnapshot& map) { return pretty_text(to_json(map)); }

}  // namespace kinemap
