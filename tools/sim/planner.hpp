// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/sim/building.hpp"

namespace kinemap::sim {

/// Finds ways on the floor that keep a body's breadth from walls and furniture: A* over a grid of clearances, then
/// pulled straight and rounded.
class Planner {
 public:
  explicit Planner(const Building& building);

  /// Points of a way from `from` to `to`, both included, some 5 cm apart. Empty when there is none.
  [[nodiscard]] std::vector<Vec2> way(const Vec2& from, const Vec2& to) const;

  /// `p` moved a little so that it has `margin` of clearance (m), as far as that is possible. From inside a wall or a
  /// piece of furniture it goes back towards `inside`, a point of the open floor near it.
  [[nodiscard]] Vec2 pushed_clear(Vec2 p, const Vec2& inside, double margin) const;

  [[nodiscard]] double clearance(const Vec2& p) const { return building_.clearance(p); }

 private:
  struct Cell {
    int x = 0, y = 0;
  };
  [[nodiscard]] Cell cell_of(const Vec2& p) const;
  [[nodiscard]] Vec2 point_of(Cell c) const { return origin_ + Vec2(c.x, c.y) * kStep; }
  [[nodiscard]] std::size_t index_of(Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(c.x);
  }
  [[nodiscard]] bool nearest_free(Cell& c) const;
  [[nodiscard]] std::vector<Vec2> search(Cell from, Cell to) const;
  [[nodiscard]] bool straight_is_clear(const Vec2& a, const Vec2& b) const;

  static constexpr double kStep = 0.08;     ///< grid, m
  static constexpr double kBody = 0.27;     ///< least clearance of the pelvis, m
  static constexpr double kComfort = 0.50;  ///< clearance that people like to keep, m
  const Building& building_;
  Vec2 origin_;
  int nx_ = 0, ny_ = 0;
  std::vector<float> clearance_;
};

}  // namespace kinemap::sim
