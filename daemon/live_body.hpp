// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "core/body.hpp"

namespace kinemap {

/// The wearer's whole body now, in the suit's drifting frame; the map's T_map_odom corrects it. Plain numbers, so that
/// the detection thread can publish it with a LatestValue.
struct LiveBody {
  bool known = false;      ///< false until the first frame
  double time_s = 0.0;     ///< stream time
  double arrived_s = 0.0;  ///< when the detection thread took the frame, s of the steady clock
  /// T_odom_segment of each segment: x y z (m), quaternion w x y z.
  std::array<std::array<double, 7>, kSegmentCount> segments{};

  [[nodiscard]] Pose T_odom(Segment segment) const {
    const auto& s = segments[static_cast<std::size_t>(segment)];
    return {{s[0], s[1], s[2]}, {s[3], s[4], s[5], s[6]}};
  }
};

inline LiveBody live_body_of(const SuitFrame& frame, double now_s) {
  LiveBody body{true, frame.time_s, now_s, {}};
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto& [p, q] = frame.segments[i];
    body.segments[i] = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
  }
  return body;
}

}  // namespace kinemap
