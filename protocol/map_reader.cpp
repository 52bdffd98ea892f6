// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

/// Walks a JSON tree with the path of where it is. The first thing that is wrong is kept and makes all later reads
/// yield defaults, so that the readers below need no branch for errors.
class Cursor {
 public:
  Cursor(const Json* json, std::string path, std::optional<Error>& error)
      : json_(json), path_(std::move(path)), error_(&error) {}

  [[nodiscard]] bool has(const char* key) const { return json_ && json_->is_object() && json_->contains(key); }

  [[nodiscard]] Cursor at(const char* key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (has(key)) return {&(*json_)[key], path, *error_};
    if (json_) fail(path, "missing");
    return {nullptr, path, *error_};
  }

  /// All items of an array; `expected` of them when given.
  [[nodiscard]] std::vector<Cursor> items(std::size_t expected = 0) const {
    std::vector<Cursor> result;
    if (json_ && (!json_->is_array() || (expected && json_->size() != expected)))
      fail(path_, expected ? "expected an array of " + std::to_string(expected) : "expected an array");
    else if (json_)
      for (std::size_t i = 0; i < json_->size(); ++i)
        result.emplace_back(&(*json_)[i], path_ + "[" + std::to_string(i) + "]", *error_);
    return result;
  }

  [[nodiscard]] double number() const {
    if (json_ && json_->is_number() && std::isfinite(json_->get<double>())) return json_->get<double>();
    if (json_) fail(path_, "expected a number");
    return 0.0;
  }
  [[nodiscard]] std::uint64_t count(std::uint64_t limit = UINT64_MAX) const {
    if (json_ && json_->is_number_unsigned() && json_->get<std::uint64_t>() <= limit)
      return json_->get<std::uint64_t>();
    if (json_) fail(path_, "expected a whole number from 0 to " + std::to_string(limit));
    return 0;
  }
  [[nodiscard]] std::string string() const {
    if (json_ && json_->is_string()) return json_->get<std::string>();
    if (json_) fail(path_, "expected a string");
    return {};
  }
  [[nodiscard]] bool boolean_or_false(const char* key) const {
    if (!has(key)) return false;
    const Cursor value = at(key);
    if (!value.json_->is_boolean()) fail(value.path_, "expected true or false");
    return value.json_->is_boolean() && value.json_->get<bool>();
  }
  template <int N>
  [[nodiscard]] Eigen::Matrix<double, N, 1> vector() const {
    Eigen::Matrix<double, N, 1> result = Eigen::Matrix<double, N, 1>::Zero();
    int i = 0;
    for (const Cursor& item : items(N)) result[i++] = item.number();
    return result;
  }
  void fail(const std::string& path, const std::string& what) const {
    if (!*error_) *error_ = Error{(path.empty() ? "(root)" : path) + ": " + what};
  }
  void fail(const std::string& what) const { fail(path_, what); }

 private:
  const Json* json_;
  std::string path_;
  std::optional<Error>* error_;
};

constexpr std::uint64_t kMaxId = UINT32_MAX;

Pose read_pose(const Cursor& json) {
  const Eigen::Vector4d q = json.at("orientation").vector<4>();
  // Rounding to 1e-6 keeps the norm within 1e-6 as well.
  if (json.has("orientation") && std::abs(q.norm() - 1.0) > 1e-3)
    json.at("orientation").fail("expected a unit quaternion");
  Pose pose{json.at("position").vector<3>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
  if (q.norm() > 0.0) pose.q.normalize();
  return pose;
}

void read_extent(const Cursor& json, MapObject& object) {
  if (json.has("plane")) {
    const Cursor plane = json.at("plane");
    object.plane = PlaneEquation{plane.at("normal").vector<3>(), plane.at("offset").number()};
  }
  if (json.has("corners")) {
    object.corners.emplace();
    std::size_t i = 0;
    for (const Cursor& corner : json.at("corners").items(4)) (*object.corners)[i++] = corner.vector<3>();
  }
  if (json.has("size")) {
    const Eigen::Vector2d size = json.at("size").vector<2>();
    object.size = {size[0], size[1]};
  }
}

ObjectSigma read_sigma(const Cursor& json) {
  ObjectSigma sigma;
  if (json.has("position")) sigma.position_m = json.at("position").number();
  if (json.has("heading")) sigma.heading_rad = json.at("heading").number();
  if (json.has("size")) {
    const Eigen::Vector2d size = json.at("size").vector<2>();
    sigma.size_m = {size[0], size[1]};
  }
  return sigma;
}

MapObject read_object(const Cursor& json) {
  MapObject object;
  object.id = static_cast<std::uint32_t>(json.at("id").count(kMaxId));
  const std::string name = json.at("type").string();
  if (const auto type = object_type_from(name))
    object.type = *type;
  else
    json.at("type").fail("unknown object type \"" + name + "\"");
  for (const Cursor& function : json.at("functions").items()) object.functions.push_back(function.string());
  object.pose = read_pose(json.at("pose"));
  read_extent(json, object);
  object.height_assumed = json.boolean_or_false("height_assumed");
  if (json.has("sigma")) object.sigma = read_sigma(json.at("sigma"));
  object.observations = static_cast<int>(json.at("observations").count(INT32_MAX));
  object.first_seen_s = json.at("first_seen").number();
  object.last_seen_s = json.at("last_seen").number();
  return object;
}

Room read_room(const Cursor& json) {
  Room room;
  room.id = static_cast<std::uint32_t>(json.at("id").count(kMaxId));
  for (const Cursor& corner : json.at("polygon").items()) room.polygon.push_back(corner.vector<2>());
  room.area_m2 = json.at("area").number();
  room.height_m = json.at("height").number();
  room.height_assumed = json.boolean_or_false("height_assumed");
  for (const Cursor& id : json.at("walls").items())
    room.wall_ids.push_back(static_cast<std::uint32_t>(id.count(kMaxId)));
  return room;
}

GraphSummary read_graph(const Cursor& json) {
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

void check_format(const Cursor& root) {
  if (const std::string format = root.at("format").string(); format != "kinemap/map")
    root.at("format").fail("expected \"kinemap/map\", got \"" + format + "\"");
  if (root.at("version").count() != 1) root.at("version").fail("this program reads version 1");
}

}  // namespace

Result<MapSnapshot> map_from_text(const std::string& text) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    return Error{"not JSON: line " + std::to_string(line) + ", byte " + std::to_string(error.byte)};
  }
  std::optional<Error> error;
  const Cursor root(&json, "", error);
  MapSnapshot map;
  check_format(root);
  map.revision = root.at("revision").count();
  map.time_s = root.at("time").number();
  for (const Cursor& object : root.at("objects").items()) map.objects.push_back(read_object(object));
  for (const Cursor& room : root.at("rooms").items()) map.rooms.push_back(read_room(room));
  for (const Cursor& trace : root.at("unresolved").items())
    map.unresolved.push_back({trace.at("begin").number(), trace.at("end").number(), trace.at("reason").string()});
  map.T_map_odom = read_pose(root.at("correction"));
  map.graph = read_graph(root.at("graph"));
  if (error) return *error;
  return map;
}

}  // namespace kinemap
