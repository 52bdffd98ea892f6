// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/mapper/stretches.hpp"

namespace kinemap {

/// A wall that nobody touched, but that must be there: the plane {p : out·p = offset}.
struct MissingWall {
  Eigen::Vector3d out;   ///< unit, level, out of the room
  double offset = 0.0;   ///< m
  double sigma_m = 0.0;  ///< of the offset
  bool step = false;     ///< between parallel walls, else between opposite ones
};

/// Infers missing walls from what is in the rooms. It stands behind the ends that were touched, behind the furniture
/// beside them, which is mostly what kept the hand from it, and behind where the wearer walked; and before what was
/// touched from its other side. Refers to what it was made of.
class MissingWalls {
 public:
  MissingWalls(const MapState& state, const TouchedWalls& walls);

  /// The wall between the head of `a` and the tail of `b`: at the end of opposite walls, or the step between parallel
  /// ones. nullopt where these do not call for one.
  [[nodiscard]] std::optional<MissingWall> between(const Stretch& a, const Stretch& b) const;

 private:
  struct Furniture {
    std::array<Eigen::Vector3d, 4> corners;
    Eigen::Vector3d facing;  ///< screens: their normal; else zero
    std::size_t zone = 0;
  };
  struct Gap;

  /// How far out the furniture reaches that stands beside what was touched, m; −∞ where there is none.
  [[nodiscard]] double furniture(const Gap& gap) const;
  /// How far out the wearer walked, m; −∞ where nobody did, or went on through a door.
  [[nodiscard]] double walked(const Gap& gap) const;
  /// How far out the inner face of a partition is whose other face was touched.
  [[nodiscard]] std::optional<double> partition(const Gap& gap) const;

  const std::vector<Pose>& poses_;
  const TouchedWalls& walls_;
  std::vector<Furniture> furniture_;
};

}  // namespace kinemap
