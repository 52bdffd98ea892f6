// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
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

/// Infers missing walls from what is in the rooms. It stands behind the ends that were touched, behind the places from
/// which anything was touched and behind the furniture, which is mostly what kept the hand from it; and before what was
/// touched from its other side.
class MissingWalls {
 public:
  MissingWalls(const MapState& state, const TouchedWalls& walls);

  /// The wall between the head of `a` and the tail of `b`: at the end of opposite walls, or the step between parallel
  /// ones. nullopt where these do not call for one.
  [[nodiscard]] std::optional<MissingWall> between(const Stretch& a, const Stretch& b) const;

 private:
  struct Furniture {
    Eigen::Vector3d corner;
    Eigen::Vector3d facing;  ///< screens: their normal; else zero
    std::size_t zone = 0;
  };
  struct Place {
    Eigen::Vector3d p;
    std::size_t zone = 0;
  };
  struct Gap;

  /// How far out the farthest of the furniture and of the wearer's places reaches, m; −∞ where there is none.
  [[nodiscard]] double furniture(const Gap& gap) const;
  [[nodiscard]] double wearer(const Gap& gap) const;
  /// How far out the inner face of a partition is whose other face was touched.
  [[nodiscard]] std::optional<double> partition(const Gap& gap) const;

  const std::vector<Stretch>& walls_;
  std::vector<Furniture> furniture_;
  std::vector<Place> places_;
};

}  // namespace kinemap
