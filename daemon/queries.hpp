// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "core/map.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/url.hpp"

/// The questions that HTTP and WebSocket clients ask, as pure functions over a snapshot. daemon/README.md is the
/// specification.
namespace kinemap {

/// What went wrong for the client, as in {"error": {"code": …, "message": …}}.
struct ApiError {
  unsigned status = 400;  ///< the HTTP status that says the same
  std::string code;       ///< for programs: "bad_parameter", "not_found", …
  std::string message;    ///< for people: what is allowed instead
};

/// JSON text, or why there is none.
using Answer = std::variant<std::string, ApiError>;

/// Parameters: type (one or several, with commas), function, near=x,y (m, map frame), within (m, needs near), limit.
/// With `near` the objects come by their level distance from it (to the nearest point of their outline), else by id.
Answer query_objects(const MapSnapshot& map, const Params& params);
Answer query_object(const MapSnapshot& map, std::string_view id);

/// The optimised key poses; parameters since, until (s of stream time, both inclusive).
Answer query_trajectory(const MapSnapshot& map, const Params& params);

/// Where the wearer is now: T_map_odom · T_odom_pelvis.
Answer query_pose(const MapSnapshot& map, const LivePose& pose);

/// Level distance (m) from a point of the map frame to the object's outline, 0 inside it.
double level_distance(const MapObject& object, const Eigen::Vector2d& point);

/// {"error": {"code": …, "message": …}}
std::string error_text(const ApiError& error);

}  // namespace kinemap
