// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tools/sim/drift.hpp"

namespace kinemap::sim {

/// The magnetic field in a building: the earth's, bent a little everywhere by what is in the walls, and much beside the
/// metal that draws the suit's heading away. 1 is the undisturbed strength.
class MagneticWorld {
 public:
  MagneticWorld(const std::vector<MagneticPatch>& patches, Random& random);
  /// Field at a point, both in the building's frame.
  [[nodiscard]] Vec3 at(const Vec3& p) const;

 private:
  struct Wave {
    Vec3 number, amplitude;
    double phase;
  };
  const std::vector<MagneticPatch>& patches_;
  Vec3 earth_;
  std::array<Wave, 4> waves_;
  std::vector<Vec3> bent_;  ///< per patch: what it adds
};

}  // namespace kinemap::sim
