// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>

#include "protocol/recording.hpp"

namespace kinemap::fuzz {

/// Reads the recording to its end; ends the program when a frame came out that must not.
inline void read_frames(const std::string& path) {
  double last_s = 0.0;
  const RecordingSink sink{[&last_s](const SuitFrame& frame) {
                             if (frame.time_s < last_s) std::abort();
                             last_s = frame.time_s;
                             for (const Pose& pose : frame.segments)
                               if (!pose.p.allFinite() || !pose.q.coeffs().allFinite()) std::abort();
                           },
                           [](const WearerInfo&) {}};
  const auto summary = read_recording(path, {}, sink);
  if (!summary && summary.error().empty()) std::abort();
}

}  // namespace kinemap::fuzz
