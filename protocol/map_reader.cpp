// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "protocol/json_cursor.hpp"
#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

constexpr std::uint64_t kMaxId = UINT32_MAX;

Pose read_pose(const JsonCursor& json) {
  const Eigen::Vector4d q = json.at("orientation").vector<4>();
  // Rounding to 1e-6 keeps the norm within 1e-6 as well.
  if (json.has("orientation") && std::abs(q.norm() - 1.0) > 1e-3)
    json.at("orientation").fail("expected a unit quaternion");
  Pose pose{json.at("position").vector<3>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
  if (q.norm() > 0.0) pose.q.normalize();
  return pose;
}

void read_extent(const JsonCursor& json, MapObject& object) {
  if (json.has("plane")) {
    const JsonCursor plane = json.at("plane");
    object.plane = PlaneEquation{plane.at("normal").vector<3>(), plane.at("offset").number()};
  }
  if (json.has("corners")) {
    object.corners.emplace();
    std::size_t i = 0;
    for (const JsonCursor& corner : json.at("corners").items(4)) (*object.corners)[i++] = corner.vector<3>();
  }
  if (json.has("size")) {
    const Eigen::Vector2d size = json.at("size").vector<2>();
    object.size = {size[0], size[1]};
  }
}

ObjectSigma read_sigma(const JsonCursor& json) {
  ObjectSigma sigma;
  if (json.has("position")) sigma.position_m = json.at("position").number();
  if (json.has("heading")) sigma.heading_rad = json.at("heading").number();
  if (json.has("size")) {
    std::size_t known = 0;
    for (const JsonCursor& side : json.at("size").items()) {
      if (known == sigma.size_m.size()) {
        json.at("size").fail("expected one or two numbers");
        break;
      }
      sigma.size_m[known++] = side.number();
    }
  }
  return sigma;
}

MapObject read_object(const JsonCursor& json) {
  MapObject object;
  object.id = static_cast<std::uint32_t>(json.at("id").count(kMaxId));
  const std::string name = json.at("type").string();
  if (const auto type = object_type_from(name))
    object.type = *type;
  else
    json.at("type").fail("unknown object type \"" + name + "\"");
  for (const JsonCursor& function : json.at("functions").items()) object.functions.push_back(function.string());
  object.pose = read_pose(json.at("pose"));
  read_extent(json, object);
  object.height_assumed = json.boolean_or_false("height_assumed");
  if (json.has("ends")) {
    object.ends.emplace();
    std::size_t i = 0;
    for (const JsonCursor& end : json.at("ends").items(2)) {
      if (const auto kind = end_kind_from(end.string()))
        (*object.ends)[i++] = *kind;
      else
        end.fail("expected \"corner\", \"inferred\" or \"open\"");
    }
  }
  if (json.has("sigma")) object.sigma = read_sigma(json.at("sigma"));
  object.observations = static_cast<int>(json.at("observations").count(INT32_MAX));
  object.first_seen_s = json.at("first_seen").number();
  object.last_seen_s = json.at("last_seen").number();
  if (json.has("visits"))
    for (const JsonCursor& row : json.at("visits").items()) {
      const Eigen::Vector2d visit = row.vector<2>();
      object.visits.push_back({visit[0], visit[1]});
    }
  return object;
}

Room read_room(const JsonCursor& json) {
  Room room;
  room.id = static_cast<std::uint32_t>(json.at("id").count(kMaxId));
  for (const JsonCursor& corner : json.at("polygon").items()) room.polygon.push_back(corner.vector<2>());
  room.area_m2 = json.at("area").number();
  room.height_m = json.at("height").number();
  room.height_assumed = json.boolean_or_false("height_assumed");
  for (const JsonCursor& id : json.at("walls").items())
    room.wall_ids.push_back(static_cast<std::uint32_t>(id.count(kMaxId)));
  if (json.has("inferred_sides"))
    for (const JsonCursor& side : json.at("inferred_sides").items()) room.inferred_sides.push_back(side.count());
  return room;
}

Doorway read_doorway(const JsonCursor& json) {
  Doorway doorway;
  doorway.position = json.at("position").vector<2>();
  doorway.heading_rad = json.at("heading").number();
  for (const JsonCursor& id : json.at("rooms").items())
    doorway.room_ids.push_back(static_cast<std::uint32_t>(id.count(kMaxId)));
  return doorway;
}

TouchingHand read_hand(const JsonCursor& json) {
  TouchingHand hand;
  const std::string name = json.at("part").string();
  if (const auto part = hand_part_from(name))
    hand.part = *part;
  else
    json.at("part").fail("expected \"tips\" or \"palm\", got \"" + name + "\"");
  hand.probability = json.at("probability").number();
  hand.p_hand = json.at("touch_point").vector<3>();
  if (json.has("sigma")) hand.sigma_m = json.at("sigma").vector<3>();
  return hand;
}

MapWearer read_wearer(const JsonCursor& json) {
  MapWearer wearer;
  if (json.has("name")) wearer.name = json.at("name").string();
  if (json.has("stature")) wearer.stature_m = json.at("stature").number();
  wearer.hand = read_hand(json.at("hand"));
  return wearer;
}

GraphSummary read_graph(const JsonCursor& json) {
  GraphSummary graph;
  graph.key_poses = json.at("key_poses").count();
  graph.landmarks = json.at("landmarks").count();
  graph.contacts = json.at("contacts").count();
  graph.loop_closures = json.at("loop_closures").count();
  graph.loop_closures_revoked = json.at("loop_closures_revoked").count();
  graph.optimisations = json.at("optimisations").count();
  graph.optimisations_failed = json.at("optimisations_failed").count();
  graph.last_cost = json.at("last_cost").number();
  return graph;
}

void check_format(const JsonCursor& root) {
  if (const std::string format = root.at("format").string(); format != "kinemap/map")
    root.at("format").fail("expected \"kinemap/map\", got \"" + format + "\"");
  if (root.at("version").count() != 1) root.at("version").fail("this program reads version 1");
}

}  // namespace

Result<MapSnapshot> map_from_text(const std::string& text) {
  const auto json = parse_json(text);
  if (!json) return Error{json.error()};
  std::optional<Error> error;
  const JsonCursor root(*json, error);
  MapSnapshot map;
  check_format(root);
  map.revision = root.at("revision").count();
  map.time_s = root.at("time").number();
  for (const JsonCursor& object : root.at("objects").items()) map.objects.push_back(read_object(object));
  for (const JsonCursor& room : root.at("rooms").items()) map.rooms.push_back(read_room(room));
  if (root.has("doorways"))
    for (const JsonCursor& doorway : root.at("doorways").items()) map.doorways.push_back(read_doorway(doorway));
  for (const JsonCursor& trace : root.at("unresolved").items())
    map.unresolved.push_back({trace.at("begin").number(), trace.at("end").number(), trace.at("reason").string()});
  map.T_map_odom = read_pose(root.at("correction"));
  if (root.has("hand")) map.hand = read_hand(root.at("hand"));
  if (root.has("wearers"))
    for (const JsonCursor& wearer : root.at("wearers").items()) map.wearers.push_back(read_wearer(wearer));
  map.graph = read_graph(root.at("graph"));
  if (error) return *error;
  return map;
}

Result<std::vector<MapObject>> objects_from_text(const std::string& text) {
  const auto json = parse_json(text);
  if (!json) return Error{json.error()};
  std::optional<Error> error;
  std::vector<MapObject> objects;
  for (const JsonCursor& object : JsonCursor(*json, error).at("objects").items())
    objects.push_back(read_object(object));
  if (error) return *error;
  return objects;
}

}  // namespace kinemap
