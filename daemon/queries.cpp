// SPDX-License-Identifier: Apache-2.0
#include "daemon/queries.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "daemon/params.hpp"
#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest = 1e6;
constexpr std::size_t kMostObjects = 100000;

/// Text from outside (names) may hold anything: bytes that are no UTF-8 are replaced.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - (a + t * ab)).norm();
}

struct Filter {
  std::vector<ObjectType> types;
  std::optional<std::string> function;
  std::optional<Eigen::Vector2d> near;
  double within_m = std::numeric_limits<double>::infinity();
  std::size_t limit = kMostObjects;

  [[nodiscard]] bool takes(const MapObject& object, double distance_m) const {
    const auto& names = object.functions;
    return (types.empty() || std::find(types.begin(), types.end(), object.type) != types.end()) &&
           (!function || std::find(names.begin(), names.end(), *function) != names.end()) && distance_m <= within_m;
  }
};

Filter read_filter(ParamReader& reader) {
  Filter filter;
  for (const auto& name : reader.list("type")) {
    const auto type = object_type_from(name);
    if (type)
      filter.types.push_back(*type);
    else
      reader.fail("type", name, "one or several of wall, table, screen, chair");
  }
  filter.function = reader.text("function");
  if (const auto near = reader.point("near")) filter.near = near->p.head<2>();
  if (const auto within = reader.number("within", 0.0, kFarthest)) {
    if (!filter.near) reader.fail("within", *reader.text("within"), "used with near=x,y");
    filter.within_m = *within;
  }
  filter.limit = reader.count("limit", 1, kMostObjects).value_or(kMostObjects);
  return filter;
}

ApiError no_suit() {
  return {503, "no_suit", "no frame of a suit has come yet; /api/v1/status says what was received"};
}

Json head_of(const MapSnapshot& map, const LiveBody& body, double now_s) {
  return {{"time", rounded(body.time_s)},
          {"age", rounded(std::max(0.0, now_s - body.arrived_s))},
          {"revision", map.revision},
          {"frame", "map"}};
}

struct Found {
  const MapObject* object;
  double distance_m;
};

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

std::vector<ParamSpec> object_params() {
  return {{"type", R"({"type":"string"})", "One or several types with commas: wall, table, screen, chair."},
          {"function", R"({"type":"string"})", "What it is for: sit, place, view, bound."},
          {"near", R"({"type":"string"})", "x,y in the map frame, m: the nearest come first."},
          {"within", R"({"type":"number","minimum":0})", "Not farther than this, m; needs near."},
          {"limit", R"({"type":"integer","minimum":1})", "At most so many."}};
}

Answer query_objects(const MapSnapshot& map, const Params& params) {
  ParamReader reader(params);
  const Filter filter = read_filter(reader);
  if (reader.error()) return *reader.error();

  std::vector<Found> found;
  for (const MapObject& object : map.objects) {
    const double distance_m = filter.near ? level_distance(object, *filter.near) : 0.0;
    if (filter.takes(object, distance_m)) found.push_back({&object, distance_m});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.distance_m < b.distance_m; });

  Json objects = Json::array();
  for (std::size_t i = 0; i < std::min(found.size(), filter.limit); ++i) {
    objects.push_back(to_json(*found[i].object));
    if (filter.near) objects.back()["distance"] = rounded(found[i].distance_m);
  }
  return text_of({{"revision", map.revision}, {"matched", found.size()}, {"objects", std::move(objects)}});
}

Answer query_object(const MapSnapshot& map, std::string_view id) {
  std::uint32_t number = 0;
  const auto [stop, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  if (error != std::errc{} || stop != id.data() + id.size())
    return ApiError{.code = "bad_parameter", .message = "an object's id is a whole number"};
  for (const MapObject& object : map.objects)
    if (object.id == number) return text_of(to_json(object));
  const std::string ids = map.objects.empty() ? "the map has no objects yet"
                                              : "ids run " + std::to_string(map.objects.front().id) + "–" +
                                                    std::to_string(map.objects.back().id);
  return ApiError{.status = 404, .code = "not_found", .message = "no object " + std::to_string(number) + "; " + ids};
}

std::vector<ParamSpec> trajectory_params() {
  return {{"since", R"({"type":"number","minimum":0})", "Not before this stream time, s."},
          {"until", R"({"type":"number","minimum":0})", "Not after this stream time, s."}};
}

Answer query_trajectory(const MapSnapshot& map, const Params& params) {
  ParamReader reader(params);
  const double since = reader.number("since", 0.0, 1e9).value_or(0.0);
  const double until = reader.number("until", 0.0, 1e9).value_or(1e9);
  if (reader.error()) return *reader.error();
  Json poses = Json::array();
  for (const TrajectoryPose& pose : map.trajectory) {
    if (pose.time_s < since || pose.time_s > until) continue;
    Json json = {{"id", pose.id}, {"time", rounded(pose.time_s)}};
    json.update(to_json(pose.T_map_pelvis));
    json["odometry"] = to_json(pose.T_odom_pelvis);
    poses.push_back(std::move(json));
  }
  return text_of({{"revision", map.revision}, {"frame", "map"}, {"poses", std::move(poses)}});
}

Answer query_pose(const MapSnapshot& map, const LiveBody& body, double now_s) {
  if (!body.known) return no_suit();
  const Pose T_odom_pelvis = body.T_odom(Segment::Pelvis);
  Json json = head_of(map, body, now_s);
  json.update(to_json(map.T_map_odom * T_odom_pelvis));
  json["odometry"] = to_json(T_odom_pelvis);
  return text_of(json);
}

Answer query_body(const MapSnapshot& map, const LiveBody& body, double now_s) {
  if (!body.known) return no_suit();
  Json json = head_of(map, body, now_s);
  Json& segments = json["segments"] = Json::array();
  const auto short_number = [](double value) { return std::round(value * 1e4) / 1e4 + 0.0; };
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose pose = map.T_map_odom * body.T_odom(static_cast<Segment>(i));
    Json& numbers = segments.emplace_back(Json::array());
    for (const double value : {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()})
      numbers.push_back(short_number(value));
  }
  json["correction"] = to_json(map.T_map_odom);
  return text_of(json);
}

std::vector<ParamSpec> map_params() {
  return {{"since", R"({"type":"integer","minimum":0})", "A revision that the client has: only what changed since."},
          {"run", R"({"type":"string"})",
           "The `run` of the map that the client has; revisions of another run are unknown."}};
}

Reply query_map(MapHistory& history, const Params& params) {
  ParamReader reader(params);
  const auto revision = reader.count("since", 0, std::numeric_limits<std::size_t>::max());
  const auto run = reader.text("run");
  if (run && !revision) reader.fail("run", *run, "used with since");
  if (reader.error()) return error_reply(*reader.error());
  return {.body = revision ? history.since({*revision, run.value_or("")}) : history.whole()};
}

std::vector<ParamSpec> event_params() {
  return {{"since", R"({"type":"integer","minimum":0})", "The number of an event: only later ones."},
          {"limit", R"({"type":"integer","minimum":1})", "At most so many, the newest."}};
}

Answer query_events(const LiveEvents& events, const Params& params) {
  ParamReader reader(params);
  const std::size_t since = reader.count("since", 0, std::numeric_limits<std::size_t>::max()).value_or(0);
  const std::size_t limit = reader.count("limit", 1, LiveEvents::kKept).value_or(LiveEvents::kKept);
  if (reader.error()) return *reader.error();
  const auto& all = events.all();
  const auto later = [&](const LiveEvent& event) { return event.number > since; };
  const auto count = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), later));
  std::string text;
  for (auto it = all.end() - static_cast<std::ptrdiff_t>(std::min(count, limit)); it != all.end(); ++it)
    text += (text.empty() ? "" : ",") + *it->data;
  return R"({"newest":)" + std::to_string(events.newest()) + R"(,"events":[)" + text + "]}";
}

}  // namespace kinemap
