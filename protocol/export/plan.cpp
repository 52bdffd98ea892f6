// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSeatHalfSide = 0.21;  ///< m, for drawing: only the middle of a seat is known

/// Heading in (−45°, 45°] that most of the wall length follows or crosses at right angles; of the path's extent when
/// there are no walls.
double main_heading(const MapSnapshot& map) {
  double c = 0.0, s = 0.0;
  for (const MapObject& object : map.objects) {
    if (!object.plane || !object.size || object.type == ObjectType::Table) continue;
    const double heading = std::atan2(object.plane->normal.y(), object.plane->normal.x());
    const double weight = object.type == ObjectType::Wall ? (*object.size)[0] : 0.1;
    c += weight * std::cos(4 * heading);
    s += weight * std::sin(4 * heading);
  }
  return std::atan2(s, c) / 4;
}

Eigen::Vector2d turned(const Eigen::Vector2d& p, double angle) {
  return {std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y()};
}

std::string size_label(const MapObject& object) {
  if (!object.size) return "";
  if (object.type == ObjectType::Wall) return format("%s%.2f m", object.open_ended() ? "≥ " : "", (*object.size)[0]);
  return format("%.2f × %.2f m", (*object.size)[0], (*object.size)[1]);
}

/// "wall 3, 4.84 × 2.50 m (height assumed), ± 0.09 m, seen 4 times, for bound"
std::string detail_of(const MapObject& object) {
  std::string text = format("%s %u", to_string(object.type), object.id);
  if (object.size) text += format(", %.2f × %.2f m", (*object.size)[0], (*object.size)[1]);
  if (object.open_ended()) text += " (an end was not touched: at least so long)";
  if (object.height_assumed) text += " (height assumed)";
  if (object.type == ObjectType::Chair || object.type == ObjectType::Table)
    text += format(", %.2f m high", object.pose.p.z());
  if (object.sigma.position_m > 0.0) text += format(", ± %.2f m", object.sigma.position_m);
  text += format(", seen %d time%s", object.observations, object.observations == 1 ? "" : "s");
  for (const std::string& function : object.functions) text += ", for " + function;
  return text;
}

Plan::Item item_of(const MapObject& object) {
  Plan::Item item{object.type,        object.id,        {}, object.pose.p.head<2>(), Eigen::Vector2d::Zero(),
                  size_label(object), detail_of(object)};
  if (object.type == ObjectType::Chair) {
    const double heading = heading_of(object.pose.q);
    item.front = {std::cos(heading), std::sin(heading)};
    const Eigen::Vector2d x = kSeatHalfSide * item.front, y(-x.y(), x.x());
    item.outline = {item.centre - x + y, item.centre + x + y, item.centre + x - y, item.centre - x - y};
  } else if (object.type == ObjectType::Table) {
    for (const Eigen::Vector3d& corner : *object.corners) item.outline.emplace_back(corner.head<2>());
  } else {
    item.front = object.plane->normal.head<2>().normalized();
    const auto [a, b] = ends_of(object);
    item.outline = {a, b};
  }
  return item;
}

void turn(Plan& plan, double angle) {
  plan.turn_rad += angle;
  for (Plan::Item& item : plan.items) {
    for (Eigen::Vector2d& p : item.outline) p = turned(p, angle);
    item.centre = turned(item.centre, angle);
    item.front = turned(item.front, angle);
  }
  for (WallStretch& wall : plan.walls) {
    wall.a = turned(wall.a, angle);
    wall.b = turned(wall.b, angle);
  }
  for (Plan::Floor& room : plan.rooms)
    for (Eigen::Vector2d& p : room.polygon) p = turned(p, angle);
  for (Eigen::Vector2d& p : plan.path) p = turned(p, angle);
}

void measure(Plan& plan) {
  bool any = false;
  const auto take = [&](const Eigen::Vector2d& p) {
    plan.low = any ? Eigen::Vector2d(plan.low.cwiseMin(p)) : p;
    plan.high = any ? Eigen::Vector2d(plan.high.cwiseMax(p)) : p;
    any = true;
  };
  for (const Plan::Item& item : plan.items)
    for (const Eigen::Vector2d& p : item.outline) take(p);
  for (const Plan::Floor& room : plan.rooms)
    for (const Eigen::Vector2d& p : room.polygon) take(p);
  for (const Eigen::Vector2d& p : plan.path) take(p);
}

}  // namespace

std::string Plan::Item::name() const { return "WTSC"[static_cast<std::size_t>(type)] + std::to_string(id); }

Plan make_plan(const MapSnapshot& map) {
  Plan plan;
  for (const MapObject& object : map.objects)
    if (object.type == ObjectType::Chair || (object.plane && object.corners)) plan.items.push_back(item_of(object));
  // Seen from above: what stands on a table is drawn after it.
  std::stable_partition(plan.items.begin(), plan.items.end(),
                        [](const Plan::Item& item) { return item.type == ObjectType::Table; });
  plan.walls = wall_stretches(map);
  plan.revision = map.revision;
  for (const Room& room : map.rooms) plan.rooms.push_back({room.id, room.polygon, room.area_m2});
  for (const TrajectoryPose& pose : map.trajectory) plan.path.emplace_back(pose.T_map_pelvis.p.head<2>());

  turn(plan, -main_heading(map));
  measure(plan);
  if ((plan.high - plan.low).y() > (plan.high - plan.low).x()) {
    turn(plan, -kPi / 2);
    measure(plan);
  }
  return plan;
}

}  // namespace kinemap
