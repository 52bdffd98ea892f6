// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "daemon/params.hpp"
#include "daemon/queries.hpp"
#include "protocol/json_text.hpp"
#include "protocol/map_json.hpp"
#include "protocol/rooms.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest = 1e6;
constexpr std::size_t kMostObjects = 100000;
constexpr const char* kTypes = "one or several, with commas, of wall, table, screen, chair";
constexpr const char* kFunctions[] = {"sit", "place", "view", "bound"};
constexpr const char* kAnyFunction = "one or several, with commas, of sit, place, view, bound";

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - (a + t * ab)).norm();
}

double area_of(const MapObject& object) { return object.size ? (*object.size)[0] * (*object.size)[1] : 0.0; }

struct Found {
  const MapObject* object;
  double distance_m;
};

/// What objects may be sorted by, the smallest first.
struct Order {
  const char* name;
  double (*key)(const Found&);
};
constexpr Order kOrders[] = {
    {"id", [](const Found& f) { return static_cast<double>(f.object->id); }},
    {"distance", [](const Found& f) { return f.distance_m; }},
    {"size", [](const Found& f) { return area_of(*f.object); }},
    {"observations", [](const Found& f) { return static_cast<double>(f.object->observations); }},
    {"first_seen", [](const Found& f) { return f.object->first_seen_s; }},
    {"last_seen", [](const Found& f) { return f.object->last_seen_s; }},
};

struct Filter {
  std::vector<ObjectType> types;
  std::vector<std::string> functions;
  std::optional<ParamReader::Point> near;
  double within_m = std::numeric_limits<double>::infinity();
  const Room* room = nullptr;
  const Order* order = kOrders;
  bool descending = false;
  std::size_t limit = kMostObjects;

  [[nodiscard]] bool takes(const MapObject& object) const {
    if (!types.empty() && std::find(types.begin(), types.end(), object.type) == types.end()) return false;
    const auto& names = object.functions;
    if (!functions.empty() &&
        std::find_first_of(names.begin(), names.end(), functions.begin(), functions.end()) == names.end())
      return false;
    return room == nullptr || is_in_room(object, *room);
  }
  [[nodiscard]] double distance_to(const MapObject& object) const {
    if (!near) return 0.0;
    return near->has_z ? distance(object, near->p) : level_distance(object, near->p.head<2>());
  }
};

std::string room_ids(const MapSnapshot& map) {
  std::string text;
  for (const Room& room : map.rooms) text += (text.empty() ? "" : ", ") + std::to_string(room.id);
  return text;
}

void read_room(ParamReader& reader, const MapSnapshot& map, Filter& filter) {
  const auto id = reader.count("room", 0, std::numeric_limits<std::uint32_t>::max());
  if (!id) return;
  const auto room = std::find_if(map.rooms.begin(), map.rooms.end(), [&](const Room& r) { return r.id == *id; });
  if (room != map.rooms.end())
    filter.room = &*room;
  else
    reader.fail("room", std::to_string(*id),
                map.rooms.empty() ? "left out: there are no rooms yet" : "one of " + room_ids(map));
}

void read_order(ParamReader& reader, Filter& filter) {
  const auto text = reader.text("sort");
  const std::string name = text.value_or(filter.near ? "distance" : "id");
  filter.descending = name.starts_with('-');
  std::string names;
  filter.order = nullptr;
  for (const Order& order : kOrders) {
    names += (names.empty() ? "" : ", ") + std::string(order.name);
    if (name.substr(filter.descending) == order.name) filter.order = &order;
  }
  if (filter.order == nullptr)
    reader.fail("sort", name, "one of " + names + ", or with a - before it the other way round");
  if (filter.order == &kOrders[1] && !filter.near) reader.fail("sort", name, "something else without near");
}

Filter read_filter(ParamReader& reader, const MapSnapshot& map) {
  Filter filter;
  for (const auto& name : reader.list("type")) {
    const auto type = object_type_from(name);
    if (type)
      filter.types.push_back(*type);
    else
      reader.fail("type", name, kTypes);
  }
  filter.functions = reader.list("function");
  for (const auto& name : filter.functions)
    if (std::find(std::begin(kFunctions), std::end(kFunctions), name) == std::end(kFunctions))
      reader.fail("function", name, kAnyFunction);
  filter.near = reader.point("near");
  if (const auto within = reader.number("within", 0.0, kFarthest)) {
    if (!filter.near) reader.fail("within", *reader.text("within"), "used with near=x,y");
    filter.within_m = *within;
  }
  read_room(reader, map, filter);
  read_order(reader, filter);
  filter.limit = reader.count("limit", 1, kMostObjects).value_or(kMostObjects);
  return filter;
}

/// The thing whose id stands in the path, or why there is none; `what` is "object" or "room".
template <class Thing>
std::variant<const Thing*, ApiError> find_by_id(const std::vector<Thing>& list, std::string_view id,
                                                const std::string& what) {
  std::uint32_t number = 0;
  const auto [stop, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  if (error != std::errc{} || stop != id.data() + id.size()) {
    const std::string given(id.substr(0, 40));
    return ApiError{.code = "bad_parameter",
                    .message = "the id of a " + what + " must be a whole number, not \"" + given + "\"",
                    .parameter = "id",
                    .given = given,
                    .allowed = "a whole number"};
  }
  for (const Thing& thing : list)
    if (thing.id == number) return &thing;
  std::string ids = "the map has no " + what + "s yet";
  if (!list.empty()) ids = "ids run " + std::to_string(list.front().id) + "–" + std::to_string(list.back().id);
  return ApiError{
      .status = 404, .code = "not_found", .message = "no " + what + " " + std::to_string(number) + "; " + ids};
}

Json room_json(const MapSnapshot& map, const Room& room) {
  Json json = to_json(room);
  Json& objects = json["objects"] = Json::array();
  for (const MapObject& object : map.objects)
    if (is_in_room(object, room)) objects.push_back(object.id);
  return json;
}

}  // namespace

double level_distance(const MapObject& object, const Eigen::Vector2d& point) {
  if (!object.corners) return (object.pose.p.head<2>() - point).norm();
  double nearest = std::numeric_limits<double>::infinity();
  int left = 0, right = 0;  // sides of the level outline that have the point on their left, right
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = (*object.corners)[i].head<2>(), b = (*object.corners)[(i + 1) % 4].head<2>();
    nearest = std::min(nearest, distance_to_segment(point, a, b));
    const double cross = (b - a).x() * (point - a).y() - (b - a).y() * (point - a).x();
    left += cross > 0.0;
    right += cross < 0.0;
  }
  return left == 4 || right == 4 ? 0.0 : nearest;
}

double distance(const MapObject& object, const Eigen::Vector3d& point) {
  if (!object.corners) return (object.pose.p - point).norm();
  const Eigen::Vector3d& corner = (*object.corners)[0];
  Eigen::Vector3d nearest = corner;
  for (const std::size_t next : {std::size_t{1}, std::size_t{3}}) {
    const Eigen::Vector3d side = (*object.corners)[next] - corner;
    const double length2 = side.squaredNorm();
    if (length2 > 0.0) nearest += std::clamp((point - corner).dot(side) / length2, 0.0, 1.0) * side;
  }
  return (nearest - point).norm();
}

std::vector<ParamSpec> object_params() {
  return {{"type", R"({"type":"string"})", "Types, one or several with commas: wall, table, screen, chair."},
          {"function", R"({"type":"string"})",
           "What it is for, one or several with commas: sit, place (put something down), view, bound."},
          {"near", R"({"type":"string"})",
           "x,y or x,y,z in the map frame, m: each object comes with its distance from there, the nearest first."},
          {"within", R"({"type":"number","minimum":0})", "Not farther than this from near, m."},
          {"room", R"({"type":"integer","minimum":0})", "In this room, its walls included."},
          {"sort", R"({"type":"string"})",
           "id, distance, size (area), observations, first_seen or last_seen; -size: the largest first."},
          {"limit", R"({"type":"integer","minimum":1,"maximum":100000})", "At most so many."}};
}

Answer query_objects(const MapSnapshot& map, const Params& params) {
  ParamReader reader(params);
  const Filter filter = read_filter(reader, map);
  if (reader.error()) return *reader.error();

  std::vector<Found> found;
  for (const MapObject& object : map.objects) {
    if (!filter.takes(object)) continue;
    const double distance_m = filter.distance_to(object);
    if (distance_m <= filter.within_m) found.push_back({&object, distance_m});
  }
  std::stable_sort(found.begin(), found.end(), [&](const Found& a, const Found& b) {
    return filter.descending ? filter.order->key(b) < filter.order->key(a)
                             : filter.order->key(a) < filter.order->key(b);
  });

  Json objects = Json::array();
  for (std::size_t i = 0; i < std::min(found.size(), filter.limit); ++i) {
    objects.push_back(to_json(*found[i].object));
    if (filter.near) objects.back()["distance"] = rounded(found[i].distance_m);
  }
  return compact_text({{"revision", map.revision}, {"matched", found.size()}, {"objects", std::move(objects)}});
}

Answer query_object(const MapSnapshot& map, std::string_view id) {
  const auto object = find_by_id(map.objects, id, "object");
  if (const auto* error = std::get_if<ApiError>(&object)) return *error;
  return compact_text(to_json(*std::get<0>(object)));
}

Answer query_rooms(const MapSnapshot& map) {
  Json rooms = Json::array();
  for (const Room& room : map.rooms) rooms.push_back(room_json(map, room));
  return compact_text({{"revision", map.revision}, {"rooms", std::move(rooms)}});
}

Answer query_room(const MapSnapshot& map, std::string_view id) {
  const auto room = find_by_id(map.rooms, id, "room");
  if (const auto* error = std::get_if<ApiError>(&room)) return *error;
  return compact_text(room_json(map, *std::get<0>(room)));
}

}  // namespace kinemap
