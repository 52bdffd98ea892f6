// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/entities.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "protocol/floor.hpp"
#include "protocol/foxglove/json.hpp"
#include "protocol/map_json.hpp"
#include "protocol/triangulate.hpp"

namespace kinemap::foxglove {
namespace {

constexpr double kSlab = 0.03;      ///< m: a suit that touches faces knows nothing of their thickness
constexpr double kSeatSide = 0.42;  ///< m: nor of the shape of a seat; only where it is and which way it faces
constexpr double kBackHeight = 0.4;
constexpr double kWay = 0.8;  ///< m: length of the line through a doorway
constexpr double kLabelPixels = 14.0, kLinePixels = 2.0;

constexpr Colour kWall{0.62, 0.68, 0.76, 0.35}, kTable{0.72, 0.45, 0.20, 1.0}, kScreen{0.16, 0.34, 0.72, 1.0},
    kChair{0.20, 0.60, 0.36, 1.0}, kFloor{0.62, 0.60, 0.55, 0.35}, kDoorway{0.10, 0.70, 0.30, 1.0};

const Colour& colour_of(ObjectType type) {
  switch (type) {
    case ObjectType::Wall:
      return kWall;
    case ObjectType::Table:
      return kTable;
    case ObjectType::Screen:
      return kScreen;
    case ObjectType::Chair:
      break;
  }
  return kChair;
}

Colour opaque(Colour colour) {
  colour[3] = 1.0;
  return colour;
}

Json points_json(const std::vector<Eigen::Vector3d>& points) {
  Json json = Json::array();
  for (const Eigen::Vector3d& point : points) json.push_back(vector_json(point));
  return json;
}

Json cube(const Pose& pose, const Eigen::Vector3d& size, const Colour& colour) {
  return {{"pose", pose_json(pose)}, {"size", vector_json(size)}, {"color", colour_json(colour)}};
}

enum class LineType { Strip, Loop, List };
Json line(LineType type, const std::vector<Eigen::Vector3d>& points, const Colour& colour) {
  return {{"type", static_cast<int>(type)}, {"pose", pose_json({})},         {"thickness", kLinePixels},
          {"scale_invariant", true},        {"points", points_json(points)}, {"color", colour_json(colour)},
          {"colors", Json::array()},        {"indices", Json::array()}};
}

Json triangles(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
               const Colour& colour) {
  Json indices = Json::array();
  for (const auto& face : faces)
    for (const std::uint32_t corner : face) indices.push_back(corner);
  return {{"pose", pose_json({})},
          {"points", points_json(points)},
          {"color", colour_json(colour)},
          {"colors", Json::array()},
          {"indices", std::move(indices)}};
}

Json label(const Eigen::Vector3d& p, const std::string& text, const Colour& colour) {
  return {{"pose", pose_json({p, Eigen::Quaterniond::Identity()})},
          {"billboard", true},
          {"font_size", kLabelPixels},
          {"scale_invariant", true},
          {"color", colour_json(opaque(colour))},
          {"text", text}};
}

Json empty_entity(const std::string& id, double time_s) {
  Json json = {{"timestamp", time_json(time_s)},
               {"frame_id", kMapFrame},
               {"id", id},
               {"lifetime", {{"sec", 0}, {"nsec", 0}}},  // for ever
               {"frame_locked", true}};
  for (const char* list :
       {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
    json[list] = Json::array();
  return json;
}

/// The slab behind a rectangle, its face where the hand touched. Axes: along two sides, and the normal.
Json slab(const std::array<Eigen::Vector3d, 4>& corners, const Eigen::Vector3d& normal, const Colour& colour) {
  const Eigen::Vector3d along = corners[1] - corners[0], across = corners[2] - corners[1];
  Eigen::Matrix3d axes;
  axes.col(0) = along.normalized();
  axes.col(1) = normal.cross(axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Eigen::Vector3d centre = (corners[0] + corners[2]) / 2 - normal * kSlab / 2;
  return cube({centre, Eigen::Quaterniond(axes)}, {along.norm(), across.norm(), kSlab}, colour);
}

void add_seat(Json& entity, const Pose& pose, const Colour& colour) {
  const auto part = [&](const Eigen::Vector3d& centre, const Eigen::Vector3d& size) {
    entity["cubes"].push_back(cube({pose * centre, pose.q}, size, colour));
  };
  part({0, 0, -kSlab / 2}, {kSeatSide, kSeatSide, kSlab});
  part({-(kSeatSide + kSlab) / 2, 0, kBackHeight / 2}, {kSlab, kSeatSide, kBackHeight});
}

/// "table 3, 1.60 × 0.80 m"
std::string label_text(const MapObject& object) {
  std::string text = std::string(to_string(object.type)) + " " + std::to_string(object.id);
  char size[64];
  if (object.size) {
    std::snprintf(size, sizeof size, ", %.2f × %.2f m", (*object.size)[0], (*object.size)[1]);
    text += size;
  }
  return text;
}

/// The values of the map's JSON, each as text.
Json metadata(const MapObject& object) {
  Json list = Json::array();
  const Json values = to_json(object);
  for (const char* key :
       {"type", "functions", "size", "height_assumed", "ends", "sigma", "observations", "first_seen", "last_seen"})
    if (const auto value = values.find(key); value != values.end())
      list.push_back({{"key", key}, {"value", value->is_string() ? value->get<std::string>() : text_of(*value)}});
  return list;
}

Entity entity_of(const MapObject& object) {
  const Colour& colour = colour_of(object.type);
  const std::string id = "object/" + std::to_string(object.id);
  Json json = empty_entity(id, object.first_seen_s);
  json["metadata"] = metadata(object);
  Eigen::Vector3d top = object.pose.p;  // where the label stands
  if (object.corners)
    for (const Eigen::Vector3d& corner : *object.corners) top.z() = std::max(top.z(), corner.z());
  if (object.type == ObjectType::Chair) {
    add_seat(json, object.pose, colour);
    top.z() += kBackHeight;
  } else if (object.corners && object.type == ObjectType::Wall) {
    const std::vector<Eigen::Vector3d> outline(object.corners->begin(), object.corners->end());
    json["triangles"].push_back(triangles(outline, {{0, 1, 2}, {0, 2, 3}}, colour));
    json["lines"].push_back(line(LineType::Loop, outline, opaque(colour)));
  } else if (object.corners && object.plane) {
    json["cubes"].push_back(slab(*object.corners, object.plane->normal, colour));
  }
  json["texts"].push_back(label(top + Eigen::Vector3d(0, 0, 0.1), label_text(object), colour));
  return {id, object.first_seen_s, text_of(json)};
}

Entity entity_of(const Room& room, double floor_m) {
  const std::string id = "room/" + std::to_string(room.id);
  Json json = empty_entity(id, 0.0);
  std::vector<Eigen::Vector3d> outline;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& corner : room.polygon) {
    outline.emplace_back(corner.x(), corner.y(), floor_m);
    centre += outline.back() / static_cast<double>(room.polygon.size());
  }
  json["triangles"].push_back(triangles(outline, triangulate(room.polygon), kFloor));
  char text[64];
  std::snprintf(text, sizeof text, "room %u, %.1f m²", room.id, room.area_m2);
  json["texts"].push_back(label(centre, text, kFloor));
  return {id, 0.0, text_of(json)};
}

/// They have no ids of their own, so all of them are one entity.
Entity doorways_entity(const MapSnapshot& map) {
  Json json = empty_entity("doorways", 0.0);
  std::vector<Eigen::Vector3d> ends;
  const double z = floor_height(map);
  for (const Doorway& doorway : map.doorways) {
    const Eigen::Vector3d middle(doorway.position.x(), doorway.position.y(), z);
    const Eigen::Vector3d half =
        Eigen::Vector3d(std::cos(doorway.heading_rad), std::sin(doorway.heading_rad), 0) * kWay / 2;
    ends.insert(ends.end(), {middle - half, middle + half});
  }
  json["lines"].push_back(line(LineType::List, ends, kDoorway));
  return {"doorways", 0.0, text_of(json)};
}

}  // namespace

std::vector<Entity> entities(const MapSnapshot& map) {
  std::vector<Entity> list;
  for (const MapObject& object : map.objects) list.push_back(entity_of(object));
  for (const Room& room : map.rooms) list.push_back(entity_of(room, floor_height(map, &room)));
  if (!map.doorways.empty()) list.push_back(doorways_entity(map));
  return list;
}

}  // namespace kinemap::foxglove
