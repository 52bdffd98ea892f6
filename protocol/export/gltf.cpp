// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/gltf.hpp"

#include <algorithm>

#include "protocol/export/gltf_builder.hpp"
#include "protocol/export/walls.hpp"
#include "protocol/floor.hpp"
#include "protocol/map_json.hpp"
#include "protocol/triangulate.hpp"

namespace kinemap {
namespace {

using gltf::Mesh;

constexpr double kSlab = 0.03;      ///< m: a suit that touches faces knows nothing of their thickness
constexpr double kSeatSide = 0.42;  ///< m: nor of the shape of a seat; only where it is and which way it faces
constexpr double kBackHeight = 0.4;

const gltf::Material kMaterials[] = {{"wall", {0.75, 0.78, 0.82, 0.35}},
                                     {"table", {0.55, 0.33, 0.14, 1.0}},
                                     {"screen", {0.03, 0.09, 0.20, 1.0}},
                                     {"chair", {0.12, 0.42, 0.25, 1.0}}};
const gltf::Material kFloor{"floor", {0.60, 0.58, 0.53, 1.0}}, kPath{"trajectory", {0.90, 0.25, 0.05, 1.0}};

std::vector<Eigen::Vector3d> level_rectangle(const Pose& pose, double half_x, double half_y) {
  return {pose * Eigen::Vector3d(half_x, half_y, 0), pose * Eigen::Vector3d(-half_x, half_y, 0),
          pose * Eigen::Vector3d(-half_x, -half_y, 0), pose * Eigen::Vector3d(half_x, -half_y, 0)};
}

void append(Mesh& mesh, const Mesh& part) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  for (const std::uint32_t i : part.indices) mesh.indices.push_back(base + i);
}

/// A seat with a back rest behind the sitter.
Mesh seat_mesh(const Pose& pose) {
  const double half = kSeatSide / 2;
  Mesh mesh = gltf::slab(level_rectangle(pose, half, half), pose.q * Eigen::Vector3d::UnitZ(), kSlab);
  const std::vector<Eigen::Vector3d> back = {
      pose * Eigen::Vector3d(-half, -half, 0), pose * Eigen::Vector3d(-half, half, 0),
      pose * Eigen::Vector3d(-half, half, kBackHeight), pose * Eigen::Vector3d(-half, -half, kBackHeight)};
  append(mesh, gltf::slab(back, pose.q * Eigen::Vector3d::UnitX(), kSlab));
  return mesh;
}

/// What of a wall is left between its doorways.
Mesh wall_mesh(std::span<const WallStretch> stretches) {
  Mesh mesh;
  for (const WallStretch& wall : stretches) {
    if (wall.open) continue;
    const auto corner = [](const Eigen::Vector2d& p, double z) { return Eigen::Vector3d(p.x(), p.y(), z); };
    const Eigen::Vector2d normal = wall.normal();
    append(mesh, gltf::slab({corner(wall.b, wall.bottom_z), corner(wall.a, wall.bottom_z), corner(wall.a, wall.top_z),
                             corner(wall.b, wall.top_z)},
                            {normal.x(), normal.y(), 0.0}, kSlab));
  }
  return mesh;
}

/// The rectangle of a planar object, corners turned so that they run counter-clockwise about the plane's normal.
Mesh planar_mesh(const MapObject& object) {
  std::vector<Eigen::Vector3d> outline(object.corners->begin(), object.corners->end());
  const Eigen::Vector3d& normal = object.plane->normal;
  if ((outline[1] - outline[0]).cross(outline[2] - outline[1]).dot(normal) < 0.0)
    std::reverse(outline.begin(), outline.end());
  return gltf::slab(outline, normal, kSlab);
}

Mesh floor_mesh(const Room& room, double z) {
  Mesh mesh;
  for (const Eigen::Vector2d& p : room.polygon) {
    mesh.positions.emplace_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
    mesh.normals.push_back(Eigen::Vector3f::UnitZ());
  }
  for (const auto& [a, b, c] : triangulate(room.polygon)) mesh.indices.insert(mesh.indices.end(), {a, b, c});
  return mesh;
}

/// Empty where nothing is known of the object's extent.
Mesh mesh_of(const MapObject& object, const std::vector<WallStretch>& walls) {
  if (object.type == ObjectType::Chair) return seat_mesh(object.pose);
  if (!object.plane || !object.corners) return {};
  return object.type == ObjectType::Wall ? wall_mesh(stretches_of(walls, object.id)) : planar_mesh(object);
}

}  // namespace

std::string glb_bytes(const MapSnapshot& map) {
  gltf::Builder builder;
  const std::vector<WallStretch> walls = wall_stretches(map);
  const std::vector<double> floors = floor_heights(map);
  for (std::size_t i = 0; i < map.rooms.size(); ++i)
    if (const Mesh mesh = floor_mesh(map.rooms[i], floors[i]); !mesh.indices.empty())
      builder.add_node("room " + std::to_string(map.rooms[i].id), mesh, kFloor, to_json(map.rooms[i]));
  for (const MapObject& object : map.objects) {
    const std::string name = std::string(to_string(object.type)) + " " + std::to_string(object.id);
    builder.add_node(name, mesh_of(object, walls), kMaterials[static_cast<std::size_t>(object.type)], to_json(object));
  }
  if (map.trajectory.size() >= 2) {
    Mesh line;
    for (const TrajectoryPose& pose : map.trajectory) line.positions.emplace_back(pose.T_map_pelvis.p.cast<float>());
    builder.add_node("trajectory", line, kPath);
  }
  return builder.bytes();
}

}  // namespace kinemap
