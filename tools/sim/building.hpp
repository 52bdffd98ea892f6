// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "tools/sim/geometry.hpp"
#include "tools/sim/options.hpp"
#include "tools/sim/random.hpp"

namespace kinemap::sim {

inline constexpr double kDoorwayWidth = 0.90;
inline constexpr double kRoomHeight = 2.5;

/// A rectangle on the floor: what furniture covers, or what must stay free.
struct Footprint {
  Vec2 centre = Vec2::Zero();
  double heading = 0.0;  ///< of the local x axis
  Vec2 half{0.0, 0.0};   ///< half extents along local x and y, m

  [[nodiscard]] std::array<Vec2, 4> corners() const;   ///< counter-clockwise from local (−, −)
  [[nodiscard]] double distance(const Vec2& p) const;  ///< 0 inside
  [[nodiscard]] Footprint grown(double margin) const { return {centre, heading, half + Vec2(margin, margin)}; }
};
/// Distance between two footprints; 0 when they overlap.
double gap(const Footprint& a, const Footprint& b);

/// One edge of a room's polygon, seen from inside: the interior lies to the left of a → b. A partition between two
/// rooms is two faces, one in each room. A face keeps its full length (corner to corner) even where a doorway breaks
/// it.
struct WallFace {
  int id = 0;
  int room = 0;
  Vec2 a, b;
  std::optional<std::pair<double, double>> doorway;  ///< opening, metres from a

  [[nodiscard]] double length() const { return (b - a).norm(); }
  [[nodiscard]] Vec2 along() const { return (b - a).normalized(); }
  [[nodiscard]] Vec2 inward() const { return left_of(along()); }
};

/// A part of a wall's face.
struct Stretch {
  double from = 0.0, to = 0.0;  ///< metres from the face's start
};

struct Table {
  int id = 0;
  int room = 0;
  Footprint top;  ///< local x along the longer side
  double height = 0.74;
  bool carries_screen = false;
};

struct Screen {
  int id = 0;
  int room = 0;
  bool big = false;
  Vec3 centre;
  double heading = 0.0;  ///< of the normal, towards who looks at it
  double width = 0.0, height = 0.0;
  int table = -1;  ///< index into Building::tables of the table that it stands on
};

struct Chair {
  int id = 0;
  int room = 0;
  Vec2 seat;             ///< centre of the seat
  double heading = 0.0;  ///< where the sitter faces
  double height = 0.45;  ///< of the seat over the floor
};

struct Room {
  std::vector<Vec2> polygon;  ///< counter-clockwise
  [[nodiscard]] bool contains(const Vec2& p) const;
  [[nodiscard]] Vec2 middle() const;  ///< of the bounding box
};

/// The way from one room to the next, through a partition.
struct Doorway {
  int room_a = 0, room_b = 0;
  Vec2 centre;
  double heading = 0.0;     ///< from room_a to room_b
  double thickness = 0.12;  ///< of the partition, m
};

/// Rooms and furniture, in the building's own frame (m, floor at z = 0).
struct Building {
  Scene scene = Scene::Plain;
  std::vector<Room> rooms;
  std::vector<WallFace> walls;
  std::vector<Doorway> doorways;
  std::vector<Table> tables;
  std::vector<Screen> screens;
  std::vector<Chair> chairs;
  std::vector<Footprint> obstacles;  ///< what nobody can walk through, walls excepted

  /// True inside a room or in a doorway.
  [[nodiscard]] bool open_floor(const Vec2& p) const;
  /// Distance to the nearest wall or piece of furniture, m; 0 outside the open floor and inside furniture.
  [[nodiscard]] double clearance(const Vec2& p) const;
};

/// Parts of the face, of at least 0.8 m, that nothing keeps one from touching; in order.
std::vector<Stretch> free_stretches(const Building& building, const WallFace& wall);

/// How far the wearer can touch: nothing that is to be touched lies beyond.
struct Reach {
  double highest_m = 1.85;     ///< over the floor
  double over_table_m = 0.42;  ///< behind a table's edge
};

/// Draws a building: shells joined by doorways, then furniture with room to walk around it.
Building make_building(const SimOptions& options, const Reach& reach, Random& random);

/// Puts tables, screens and chairs into the rooms (part of make_building).
void furnish(Building& building, Scene scene, const Reach& reach, Random& random);

}  // namespace kinemap::sim
