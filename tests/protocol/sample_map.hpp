// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map.hpp"

namespace kinemap {

/// A small room with one object of each type, every optional field present in some and absent in others.
inline MapSnapshot sample_map() {
  MapSnapshot map;
  map.revision = 42;
  map.time_s = 181.25;

  MapObject wall;
  wall.id = 1;
  wall.functions = {"bound"};
  wall.pose = level_pose({4.0, 1.5, 1.25}, 3.14159265358979);
  wall.plane = PlaneEquation{{-1.0, 0.0, 0.0}, -4.0};
  wall.corners = {{{4.0, 0.0, 0.0}, {4.0, 3.0, 0.0}, {4.0, 3.0, 2.5}, {4.0, 0.0, 2.5}}};
  wall.size = {3.0, 2.5};
  wall.height_assumed = true;
  wall.ends = {EndKind::Corner, EndKind::Open};
  wall.sigma = {0.03, 0.01, {0.05, 0.0}};  // the height's is unknown
  wall.observations = 3;
  wall.first_seen_s = 12.5;
  wall.last_seen_s = 170.0;
  wall.visits = {{12.5, 17.25}, {90.0, 95.5}, {166.0, 170.0}};

  MapObject table;
  table.id = 2;
  table.type = ObjectType::Table;
  table.functions = {"place"};
  table.pose = level_pose({2.0, 1.0, 0.74}, 0.3);
  table.plane = PlaneEquation{{0.0, 0.0, 1.0}, 0.74};
  table.corners = {{{1.2, 0.6, 0.74}, {2.8, 0.6, 0.74}, {2.8, 1.4, 0.74}, {1.2, 1.4, 0.74}}};
  table.size = {1.6, 0.8};
  table.sigma = {0.02, 0.015, {0.03, 0.02}};
  table.observations = 1;

  MapObject screen;
  screen.id = 5;
  screen.type = ObjectType::Screen;
  screen.functions = {"view"};
  screen.pose = level_pose({0.05, 1.5, 1.4}, 0.0);
  screen.plane = PlaneEquation{{1.0, 0.0, 0.0}, 0.05};
  // Clockwise when seen from the front: the order is not promised.
  screen.corners = {{{0.05, 1.0, 1.1}, {0.05, 1.0, 1.7}, {0.05, 2.0, 1.7}, {0.05, 2.0, 1.1}}};
  screen.size = {1.0, 0.6};
  screen.observations = 2;

  MapObject chair;
  chair.id = 7;
  chair.type = ObjectType::Chair;
  chair.functions = {"sit"};
  chair.pose = level_pose({2.0, 0.2, 0.46}, 1.5707963);
  chair.observations = 4;

  map.objects = {wall, table, screen, chair};
  map.rooms = {{1, {{0, 0}, {4, 0}, {4, 3}, {2, 3}, {2, 2}, {0, 2}}, 10.0, 2.5, true, {1}, {2, 3}}};
  map.doorways = {{{4.0, 1.2}, 3.14, {1}}};
  for (KeyPoseId i = 0; i < 4; ++i) {
    const double x = 0.5 + 0.25 * i;
    const StepSigma step = i > 0 ? StepSigma{0.01, 0.005, 0.009, 0.02} : StepSigma{};
    map.trajectory.push_back({i, 0.5 * i, level_pose({x, 1.0, 0.95}, 0.1), level_pose({x, 1.1, 0.96}, 0.2), step});
  }
  map.unresolved = {{20.0, 24.5, "neither closed nor long"}};
  map.T_map_odom = level_pose({0.1, -0.2, 0.0}, -0.1);
  map.hand = TouchingHand{HandPart::Palm, 0.9, {0.0, -0.09, -0.02}, {0.015, 0.02, 0.015}};
  map.wearers = {{"Anna", 1.68, {HandPart::Tips, 0.97, {0.0, -0.18, -0.01}, {0.01, 0.012, 0.01}}},
                 {"", std::nullopt, *map.hand}};
  map.graph = {4, 4, 120, 2, 1, 5, 0, 17.25};
  return map;
}

}  // namespace kinemap
