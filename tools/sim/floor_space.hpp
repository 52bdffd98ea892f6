// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/building.hpp"

namespace kinemap::sim {

/// A spot along a wall: `u` metres from its start.
struct WallSpot {
  const WallFace* wall = nullptr;
  double u = 0.0;
};

/// Where on the floor there is still room for a piece of furniture, and for people around it.
class FloorSpace {
 public:
  static constexpr double kWalkway = 0.85;  ///< free breadth around what one walks round, m

  FloorSpace(Building& building, Random& random);

  /// Nothing may stand there from now on.
  void keep_free(const Footprint& zone) { keep_free_.push_back(zone); }
  [[nodiscard]] bool keeps_free(const Footprint& f) const;

  /// Inside the room with every corner.
  [[nodiscard]] bool inside(int room, const Footprint& f) const;
  [[nodiscard]] double gap_to_furniture(const Footprint& f) const;
  [[nodiscard]] double gap_to_walls(int room, const Footprint& f, const WallFace* except) const;

  /// Puts these pieces there, as obstacles; unless one of the room's walls could no longer be touched then.
  bool settle(int room, const std::vector<Footprint>& pieces);

  /// A place along a wall of the room for something of this half length; nullopt when every wall is too short.
  std::optional<WallSpot> draw_spot(int room, double half_length);
  /// Draws a place for `f` (its size is given): along a wall, perhaps in a corner, or freely with a way around it. One
  /// try each: false when there is no room there.
  bool place_at_wall(int room, Footprint& f);
  bool place_freely(int room, Footprint& f);

 private:
  Building& b_;
  Random& random_;
  std::vector<Footprint> keep_free_;
};

}  // namespace kinemap::sim
