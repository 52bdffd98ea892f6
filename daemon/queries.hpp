// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "core/map.hpp"
#include "daemon/live_events.hpp"
#include "daemon/map_history.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/routes.hpp"

/// The questions that HTTP and WebSocket clients ask, as pure functions over a snapshot. protocol/README.md is the
/// specification.
namespace kinemap {

/// By type, function, place and room; `object_params` has the parameters. With `near` the objects come with their
/// distance, level (to their outline) or in space (to their surface).
std::vector<ParamSpec> object_params();
Answer query_objects(const MapSnapshot& map, const Params& params);
Answer query_object(const MapSnapshot& map, std::string_view id);

/// Each room with the ids of the objects in it.
Answer query_rooms(const MapSnapshot& map);
Answer query_room(const MapSnapshot& map, std::string_view id);

/// The optimised key poses; parameters since, until (s of stream time, both inclusive), every (s), odometry.
std::vector<ParamSpec> trajectory_params();
Answer query_trajectory(const MapSnapshot& map, const Params& params);

/// Where the wearer is now: T_map_odom · T_odom_pelvis; `now_s` is the steady clock's.
Answer query_pose(const MapSnapshot& map, const LiveBody& body, double now_s);
/// The same for each segment.
Answer query_body(const MapSnapshot& map, const LiveBody& body, double now_s);

/// The whole map, or with since (and run) what changed.
std::vector<ParamSpec> map_params();
Reply query_map(MapHistory& history, const Params& params);

/// The newest events; parameters since (number of an event that the client has), limit.
std::vector<ParamSpec> event_params();
Answer query_events(const LiveEvents& events, const Params& params);

/// Level distance (m) from a point of the map frame to the object's outline, 0 inside it.
double level_distance(const MapObject& object, const Eigen::Vector2d& point);
/// Distance (m) from a point of the map frame to the object's rectangle; a chair's to the seat's centre.
double distance(const MapObject& object, const Eigen::Vector3d& point);

}  // namespace kinemap
