// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/sdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/mapper/polygon.hpp"
#include "protocol/export/walls.hpp"
#include "protocol/floor.hpp"
#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

constexpr double kSlab = 0.03;  // m: table tops, seats, screens
constexpr double kLeg = 0.05;   // m: side of a leg
constexpr double kSeatSide = 0.42;
constexpr double kBackHeight = 0.4;

struct Box {
  Pose T_map_box;  ///< its middle
  Eigen::Vector3d size;
};

/// "x y z roll pitch yaw", the rotations about the fixed axes x, y, z in this order.
std::string pose_text(const Pose& pose) {
  const Eigen::Matrix3d r = pose.q.toRotationMatrix();
  const double roll = std::atan2(r(2, 1), r(2, 2)), pitch = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
  std::string text = "<pose>";
  for (const double value : {pose.p.x(), pose.p.y(), pose.p.z(), roll, pitch, std::atan2(r(1, 0), r(0, 0))})
    text += format(text.back() == '>' ? "%.5f" : " %.5f", std::abs(value) < 5e-6 ? 0.0 : value);  // and no -0
  return text + "</pose>";
}

std::string box_text(const char* kind, std::size_t number, const Pose& T_model_box, const Eigen::Vector3d& size,
                     const std::string& material) {
  return format("        <%s name=\"%s_%zu\">%s<geometry><box><size>%.4f %.4f %.4f</size></box></geometry>", kind, kind,
                number, pose_text(T_model_box).c_str(), size.x(), size.y(), size.z()) +
         material + format("</%s>\n", kind);
}

/// A static model of boxes; `rgba`: its colour, "red green blue opacity", each 0–1.
std::string model(const std::string& name, const Pose& T_map_model, const std::vector<Box>& boxes, const char* rgba) {
  std::string text = "    <model name=\"" + name + "\">\n      <static>true</static>\n      " + pose_text(T_map_model) +
                     "\n      <link name=\"link\">\n";
  const std::string material = format("<material><ambient>%s</ambient><diffuse>%s</diffuse></material>", rgba, rgba);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Pose T_model_box = T_map_model.inverse() * boxes[i].T_map_box;
    text += box_text("collision", i, T_model_box, boxes[i].size, "");
    text += box_text("visual", i, T_model_box, boxes[i].size, material);
  }
  return text + "      </link>\n    </model>\n";
}

Box box_of(const WallStretch& wall) {
  const Eigen::Vector2d middle = (wall.a + wall.b) / 2 - kWallThickness / 2 * wall.normal(), along = wall.along();
  return {level_pose({middle.x(), middle.y(), (wall.bottom_z + wall.top_z) / 2}, std::atan2(along.y(), along.x())),
          {wall.length(), kWallThickness, wall.top_z - wall.bottom_z}};
}

/// A level slab whose upper side lies at `pose`, on four legs.
std::vector<Box> on_legs(const Pose& pose, double length, double width, double floor) {
  std::vector<Box> boxes = {{pose * Pose{{0, 0, -kSlab / 2}, Eigen::Quaterniond::Identity()}, {length, width, kSlab}}};
  const double height = pose.p.z() - kSlab - floor;
  if (height <= 0.0) return boxes;
  for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
    const Eigen::Vector3d leg(x * (length - kLeg) / 2, y * (width - kLeg) / 2, -kSlab - height / 2);
    boxes.push_back({pose * Pose{leg, Eigen::Quaterniond::Identity()}, {kLeg, kLeg, height}});
  }
  return boxes;
}

std::vector<Box> chair(const Pose& pose, double floor) {
  std::vector<Box> boxes = on_legs(pose, kSeatSide, kSeatSide, floor);
  const Eigen::Vector3d back(-(kSeatSide + kSlab) / 2, 0.0, kBackHeight / 2);
  boxes.push_back({pose * Pose{back, Eigen::Quaterniond::Identity()}, {kSlab, kSeatSide, kBackHeight}});
  return boxes;
}

/// A slab behind the face; +x of the pose is its normal.
Box screen(const MapObject& object) {
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : *object.corners)
    extent = extent.cwiseMax((object.pose.inverse() * corner).cwiseAbs());
  return {object.pose * Pose{{-kSlab / 2, 0, 0}, Eigen::Quaterniond::Identity()},
          {kSlab, 2 * extent.y(), 2 * extent.z()}};
}

/// What the models of all objects need to know.
struct Scene {
  const MapSnapshot& map;
  std::vector<WallStretch> walls;
  std::vector<double> floors;  ///< of the rooms, by index
  double lowest = 0.0;
};

/// The floor on which something at `p` stands.
double floor_below(const Scene& scene, const Eigen::Vector3d& p) {
  double floor = scene.lowest;
  for (std::size_t i = 0; i < scene.floors.size(); ++i)
    if (scene.floors[i] > floor && scene.floors[i] < p.z() && contains(scene.map.rooms[i].polygon, p.head<2>()))
      floor = scene.floors[i];
  return floor;
}

std::string model_of(const Scene& scene, const MapObject& object) {
  const std::string name = std::string(to_string(object.type)) + '_' + std::to_string(object.id);
  if (object.type == ObjectType::Chair)
    return model(name, object.pose, chair(object.pose, floor_below(scene, object.pose.p)), "0.38 0.68 0.54 1");
  if (!object.plane || !object.corners || !object.size) return "";  // nothing is known of its extent
  if (object.type == ObjectType::Table) {
    const auto& [length, width] = *object.size;
    const double floor = floor_below(scene, object.pose.p);
    return model(name, object.pose, on_legs(object.pose, length, width, floor), "0.77 0.61 0.41 1");
  }
  if (object.type == ObjectType::Screen) return model(name, object.pose, {screen(object)}, "0.19 0.33 0.48 1");
  std::vector<Box> boxes;
  for (const WallStretch& wall : stretches_of(scene.walls, object.id))
    if (!wall.open) boxes.push_back(box_of(wall));
  return model(name, object.pose, boxes, "0.85 0.87 0.89 1");
}

constexpr const char* kSurroundings = R"(    <light name="sun" type="directional">
      <cast_shadows>true</cast_shadows>
      <pose>0 0 10 0 0 0</pose>
      <diffuse>0.9 0.9 0.9 1</diffuse>
      <specular>0.2 0.2 0.2 1</specular>
      <direction>-0.4 0.2 -0.9</direction>
    </light>
    <model name="ground">
      <static>true</static>
      <pose>0 0 %.4f 0 0 0</pose>
      <link name="link">
        <collision name="collision"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision>
        <visual name="visual"><geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry><material><ambient>0.8 0.79 0.76 1</ambient><diffuse>0.8 0.79 0.76 1</diffuse></material></visual>
      </link>
    </model>
)";

}  // namespace

std::string world_sdf(const MapSnapshot& map) {
  const Scene scene{map, wall_stretches(map), floor_heights(map), floor_height(map)};
  std::string text = format(
      "<?xml version=\"1.0\"?>\n<!-- Kinemap, map revision %llu -->\n<sdf version=\"1.7\">\n"
      "  <world name=\"kinemap\">\n",
      static_cast<unsigned long long>(map.revision));
  text += format(kSurroundings, scene.lowest);
  for (const MapObject& object : map.objects) text += model_of(scene, object);
  int number = 0;
  for (const WallStretch& wall : stretches_of(scene.walls, 0))
    if (!wall.open)
      text +=
          model("inferred_wall_" + std::to_string(++number), box_of(wall).T_map_box, {box_of(wall)}, "0.7 0.72 0.76 1");
  return text + "  </world>\n</sdf>\n";
}

}  // namespace kinemap
