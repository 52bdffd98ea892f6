// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "core/mapper/config.hpp"
#include "core/mapper/missing_wall.hpp"
#include "core/mapper/stretches.hpp"

namespace kinemap {

/// How the head of one wall may meet the tail of another.
struct Join {
  enum class Kind : std::uint8_t {
    None,
    Corner,    ///< their planes intersect
    Straight,  ///< the other continues it in the same plane: one wall
    Inferred   ///< both meet a wall between them that nobody touched: also round the free end of a partition
  } kind = Kind::None;
  double head_s = 0.0;                                    ///< on the wall that ends there
  double tail_s = 0.0;                                    ///< on the wall that begins there
  double cost = std::numeric_limits<double>::infinity();  ///< about a metre of prolonging counts as one
  double sigma_m = 0.0;                                   ///< of the inferred wall's plane
};

/// Judges which heads may meet which tails. Refers to what it was made of.
class Joiner {
 public:
  Joiner(const MapState& state, const TouchedWalls& walls, const MapperConfig::Walls& config);

  [[nodiscard]] Join join(std::size_t a, std::size_t b) const;

  /// The corner where the head of `a` meets the tail of `b`, whatever it costs; None where they are too parallel.
  [[nodiscard]] Join corner(const Stretch& a, const Stretch& b) const;

  /// An end that meets nobody costs so much.
  static constexpr double kOpenCost = 6.5;

 private:
  [[nodiscard]] Join continuation(const Stretch& a, const Stretch& b) const;
  [[nodiscard]] Join inferred(const Stretch& a, const Stretch& b) const;
  [[nodiscard]] Join free_end(const Stretch& a, const Stretch& b) const;
  /// What speaks against `wall` going on from `from` to `to`, m: what was touched cuts it, or the wearer walked
  /// through.
  [[nodiscard]] double obstruction(const Stretch& wall, double from, double to, const Stretch& neighbour) const;

  const MapState& state_;
  const std::vector<Stretch>& walls_;
  MissingWalls missing_;
  double join_max_;
};

}  // namespace kinemap
