// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/remote_map.hpp"

#include "protocol/json_cursor.hpp"
#include "protocol/map_json.hpp"
#include "tools/kinemap/client.hpp"

namespace kinemap::cli {
namespace {

std::optional<Error> read_trajectory(const std::string& text, std::vector<TrajectoryPose>& trajectory) {
  const auto json = parse_json(text);
  if (!json) return Error{json.error()};
  std::optional<Error> error;
  for (const JsonCursor& pose : JsonCursor(*json, error).at("poses").items()) {
    const Eigen::Vector4d q = pose.at("orientation").vector<4>();
    trajectory.push_back({static_cast<KeyPoseId>(trajectory.size()),
                          pose.at("time").number(),
                          {pose.at("position").vector<3>(), Eigen::Quaterniond(q[0], q[1], q[2], q[3])},
                          {}});
  }
  return error;
}

}  // namespace

Result<MapSnapshot> fetch_map(const DaemonAddress& daemon) {
  const auto text = http_get(daemon, "/api/v1/map");
  if (!text) return Error{text.error()};
  auto map = map_from_text(*text);
  if (!map) return Error{daemon.text() + "/api/v1/map: " + map.error()};
  const auto poses = http_get(daemon, "/api/v1/trajectory");
  if (!poses) return Error{poses.error()};
  if (auto error = read_trajectory(*poses, map->trajectory))
    return Error{daemon.text() + "/api/v1/trajectory: " + error->message};
  return map;
}

}  // namespace kinemap::cli
