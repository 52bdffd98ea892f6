// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/truth.hpp"

#include "protocol/json_cursor.hpp"

namespace kinemap::eval {
namespace {

TruthObject read_object(const JsonCursor& json) {
  TruthObject object;
  object.id = static_cast<std::uint32_t>(json.at("id").count(UINT32_MAX));
  const std::string name = json.at("type").string();
  const auto type = object_type_from(name);
  if (!type) json.at("type").fail("unknown object type \"" + name + "\"");
  object.type = type.value_or(ObjectType::Wall);
  const Eigen::Vector4d q = json.at("pose").at("orientation").vector<4>();
  object.pose = {json.at("pose").at("position").vector<3>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
  if (object.type != ObjectType::Chair) {
    const Eigen::Vector2d size = json.at("size").vector<2>();
    if (json.has("size") && size.minCoeff() <= 0.0) json.at("size").fail("expected two lengths > 0");
    object.size = {size[0], size[1]};
  }
  if (json.has("room")) object.room = json.at("room").count();
  object.klass = class_of(object.type, object.size[0]);
  if (json.has("class")) {
    const std::string klass = json.at("class").string();
    if (klass != "big" && klass != "small") json.at("class").fail("expected \"big\" or \"small\"");
    object.klass = klass == "big" ? Class::BigScreen : Class::SmallScreen;
  }
  return object;
}

/// Those that concern an object become visits: the contact itself where it is known.
void read_intervals(const JsonCursor& json, Truth& truth) {
  for (const JsonCursor& row : json.items()) {
    if (row.at("label").string().starts_with("distractor")) ++truth.distractors;
    if (!row.has("object")) continue;
    const bool contact = row.has("contact_begin");
    truth.visits.push_back({static_cast<std::uint32_t>(row.at("object").count(UINT32_MAX)),
                            row.at(contact ? "contact_begin" : "begin").number(),
                            row.at(contact ? "contact_end" : "end").number()});
  }
}

/// A row is [t, x, y, z, qw, qx, qy, qz].
std::vector<TimedPose> read_trajectory(const JsonCursor& json) {
  std::vector<TimedPose> trajectory;
  for (const JsonCursor& row : json.items()) {
    const auto v = row.vector<8>();
    if (!trajectory.empty() && v[0] <= trajectory.back().time_s) row.fail("expected ascending times");
    trajectory.push_back({v[0], {{v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]}}});
  }
  return trajectory;
}

}  // namespace

Result<Truth> truth_from_text(const std::string& text) {
  const auto json = parse_json(text);
  if (!json) return Error{json.error()};
  std::optional<Error> error;
  const JsonCursor root(*json, error);
  if (root.at("format").string() != "kinemap/truth") root.at("format").fail("expected \"kinemap/truth\"");
  if (root.at("version").count() != 1) root.at("version").fail("this program reads version 1");
  Truth truth;
  for (const JsonCursor& object : root.at("objects").items()) truth.objects.push_back(read_object(object));
  for (const JsonCursor& object : root.at("unvisited").items()) truth.untouched.push_back(read_object(object));
  if (root.has("rooms"))
    for (const JsonCursor& room : root.at("rooms").items()) {
      truth.rooms.emplace_back();
      for (const JsonCursor& corner : room.at("polygon").items()) truth.rooms.back().emplace_back(corner.vector<2>());
    }
  truth.trajectory = read_trajectory(root.at("trajectory"));
  if (root.has("intervals")) read_intervals(root.at("intervals"), truth);
  if (error) return *error;
  return truth;
}

const char* to_string(Class c) {
  constexpr const char* kNames[] = {"table", "big screen", "small screen", "wall", "chair"};
  static_assert(std::size(kNames) == kClassCount);
  return kNames[static_cast<std::size_t>(c)];
}

Class class_of(ObjectType type, double long_side_m) {
  switch (type) {
    case ObjectType::Wall:
      return Class::Wall;
    case ObjectType::Table:
      return Class::Table;
    case ObjectType::Chair:
      return Class::Chair;
    case ObjectType::Screen:
      break;
  }
  return long_side_m > kBigScreenM ? Class::BigScreen : Class::SmallScreen;
}

}  // namespace kinemap::eval
