// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/tracker/tracker.hpp"
#include "tests/core/tracker/postures.hpp"

namespace kinemap::test {

/// What came out of a run over frames, sorted by kind.
struct Outcome {
  std::vector<Event> events;
  std::vector<KeyPose> key_poses;
  std::vector<Trace> traces;
  std::vector<Sitting> sittings;
  TrackerStats stats;

  /// T_odom_key of a key pose.
  [[nodiscard]] const Pose& key(KeyPoseId id) const { return key_poses.at(id).T_odom_pelvis; }
};

Outcome track(const std::vector<SuitFrame>& frames, const TrackerConfig& config = {});

/// The wearers and streams over which a table of expectations is played.
struct Case {
  double stature_m;
  SuitErrors errors;
  Sampling sampling;
};
std::vector<Case> cases();
std::string describe(const Case& c);

/// Stands, does it, stands again.
std::vector<Act> between_standing(double duration_s, std::function<Figure(double)> figure);

}  // namespace kinemap::test
