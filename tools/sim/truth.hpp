// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/sim/session.hpp"

namespace kinemap::sim {

/// Collects the true trajectory while a session runs and writes all that is known of it. Map frame, m, s since the
/// first frame.
///
/// Planar objects: `pose` has +x along a table's longer side, or along the normal of a wall or screen (towards the
/// wearer). A wall is one edge of a room's polygon, corner to corner, even where a doorway breaks it; a partition is
/// two walls.
///
/// Intervals of tracing: `gesture` counts the times that the left hand went to the hip; two intervals with one number
/// are two objects drawn in one gesture. `part` of `parts`: the object was drawn in so many gestures, one after the
/// other. `lift_offs`: when, during contact, the hand was off the surface.
class TruthWriter {
 public:
  explicit TruthWriter(const Session& session) : session_(session) {}
  void add(const Sample& sample);  ///< keeps about 20 poses a second
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  struct Pelvis {
    double time_s;
    Placed pose;
  };
  const Session& session_;
  std::vector<Pelvis> trajectory_;
};

}  // namespace kinemap::sim
