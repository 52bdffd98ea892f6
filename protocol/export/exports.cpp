// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/exports.hpp"

#include <algorithm>

#include "protocol/export/gltf.hpp"
#include "protocol/export/objects_csv.hpp"
#include "protocol/export/occupancy.hpp"
#include "protocol/export/plan.hpp"
#include "protocol/export/sdf.hpp"
#include "protocol/foxglove/session.hpp"
#include "protocol/g2o.hpp"
#include "protocol/map_json.hpp"
#include "protocol/tum.hpp"

namespace kinemap {
namespace {

using enum Export::Needs;

constexpr Export kExports[] = {
    {"scene.glb", "model/gltf-binary", "3-D scene, glTF 2.0: one node an object", glb_bytes},
    {"plan.svg", "image/svg+xml", "dimensioned floor plan", plan_svg},
    {"floor.pgm", "image/x-portable-graymap", "occupancy grid, the picture (ROS map_server, Nav2)", floor_pgm,
     Trajectory},
    {"floor.yaml", "application/yaml", "occupancy grid, where the picture lies", floor_yaml, Trajectory},
    {"world.sdf", "application/xml", "static world for Gazebo, SDFormat 1.7", world_sdf},
    {"graph.g2o", "text/plain; charset=utf-8", "pose graph: optimised key poses, odometry with its noise",
     [](const MapSnapshot& map) { return g2o_text(map); }, StepSigmas},
    {"trajectory.tum", "text/plain; charset=utf-8", "optimised pelvis poses, t x y z qx qy qz qw", optimised_tum,
     Trajectory},
    {"odometry.tum", "text/plain; charset=utf-8", "the same poses as the suit gave them", odometry_tum, Trajectory},
    {"session.mcap", "application/octet-stream", "recording for Foxglove and Lichtblick, the live channels",
     foxglove::mcap_bytes, Trajectory},
    {"objects.csv", "text/csv; charset=utf-8", "table of the objects, RFC 4180", objects_csv},
    // The last one: where it is, all its companions are.
    {"map.json", "application/json", "the map with all that is known of each object", map_text},
};

}  // namespace

std::span<const Export> exports() { return kExports; }

const Export* find_export(std::string_view name) {
  const auto found =
      std::find_if(std::begin(kExports), std::end(kExports), [name](const Export& file) { return file.name == name; });
  return found == std::end(kExports) ? nullptr : found;
}

Result<std::string> export_map(const Export& file, const MapSnapshot& map) {
  const std::string name = file.name;
  if (file.needs != Objects && map.trajectory.empty() && map.graph.key_poses > 0)
    return Error{name +
                 " needs the trajectory, which map.json does not hold: give the directory with trajectory.tum "
                 "and odometry.tum beside map.json"};
  if (file.needs == StepSigmas && map.trajectory.size() > 1 && map.trajectory[1].step.level_m <= 0.0)
    return Error{name +
                 " needs the noise of the odometry, which no map file holds: take it from a running kinemapd, "
                 "or build it from the recording"};
  return file.bytes(map);
}

}  // namespace kinemap
