// SPDX-License-Identifier: Apache-2.0
#include "daemon/queries.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "daemon/params.hpp"
#include "protocol/json_text.hpp"
#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

ApiError no_suit() {
  return {503, "no_suit", "no frame of a suit has come yet; /api/v1/status says what was received"};
}

/// Variances span many powers of ten: five digits each, not a fixed number of decimals.
Json covariance_json(const Eigen::Matrix<double, 6, 6>& covariance) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < 6; ++i) {
    Json& row = rows.emplace_back(Json::array());
    for (Eigen::Index j = 0; j < 6; ++j) {
      char digits[32];
      std::snprintf(digits, sizeof digits, "%.4e", covariance(i, j));
      row.push_back(std::strtod(digits, nullptr) + 0.0);
    }
  }
  return rows;
}

Json head_of(const MapSnapshot& map, const LiveBody& body, double now_s) {
  return {{"time", rounded(body.time_s)},
          {"age", rounded(std::max(0.0, now_s - body.arrived_s))},
          {"revision", map.revision},
          {"frame", "map"}};
}

}  // namespace

std::vector<ParamSpec> trajectory_params() {
  return {{"since", R"({"type":"number","minimum":0})", "Not before this stream time, s."},
          {"until", R"({"type":"number","minimum":0})", "Not after this stream time, s."},
          {"every", R"({"type":"number","minimum":0})", "At least so long after the pose before, s: a coarser way."}};
}

Answer query_trajectory(const MapSnapshot& map, const Params& params) {
  constexpr double kLatest = 1e9;
  ParamReader reader(params);
  const double since = reader.number("since", 0.0, kLatest).value_or(0.0);
  const double until = reader.number("until", 0.0, kLatest).value_or(kLatest);
  const double every = reader.number("every", 0.0, kLatest).value_or(0.0);
  if (reader.error()) return *reader.error();
  Json poses = Json::array();
  double next_s = since;
  for (const TrajectoryPose& pose : map.trajectory) {
    if (pose.time_s < next_s || pose.time_s > until) continue;
    next_s = pose.time_s + every;
    Json json = {{"id", pose.id}, {"time", rounded(pose.time_s)}};
    json.update(to_json(pose.T_map_pelvis));
    json["odometry"] = to_json(pose.T_odom_pelvis);
    poses.push_back(std::move(json));
  }
  return compact_text({{"revision", map.revision}, {"frame", "map"}, {"poses", std::move(poses)}});
}

Answer query_pose(const MapSnapshot& map, const LiveBody& body, double now_s) {
  if (!body.known) return no_suit();
  const Pose T_odom_pelvis = body.T_odom(Segment::Pelvis);
  Json json = head_of(map, body, now_s);
  json.update(to_json(map.T_map_odom * T_odom_pelvis));
  json["odometry"] = to_json(T_odom_pelvis);
  if (map.pelvis_covariance) json["covariance"] = covariance_json(*map.pelvis_covariance);
  return compact_text(json);
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
  return compact_text(json);
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
