// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

/// What the tracker saw, for the status page.
struct TrackerStats {
  std::uint64_t frames = 0;
  std::uint64_t key_poses = 0;
  std::uint64_t traces = 0;
  std::uint64_t traces_rejected = 0;  ///< gestures too short or without motion of the right hand
  std::uint64_t pivots = 0;
  std::uint64_t sittings = 0;
  std::uint64_t contacts_thinned_out = 0;  ///< contacts left out because a trace reached its limit
  double path_m = 0.0;                     ///< length of the level pelvis path
  bool tracing = false;                    ///< the modelling gesture is held now
};

/// A fold over frames: what the wearer does, as events. Deterministic; one call costs microseconds; memory is bounded
/// by the longest trace allowed. Not thread-safe: one thread owns it.
class Tracker {
 public:
  explicit Tracker(const TrackerConfig& config);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// Before the first frame: the stream goes on where a tracker that is gone has left it, gestures too.
  /// `unseen_path_m`: how far the wearer may have walked since.
  void resume(const Interrupted& before, double unseen_path_m);

  /// Takes the next frame and appends the events that it completes, in order of time. A Trace or Sitting only refers to
  /// key poses that were emitted before it.
  void step(const SuitFrame& frame, std::vector<Event>& events);

  /// The stream ended: closes an open trace or sitting and appends a last key pose.
  void finish(std::vector<Event>& events);

  /// The next piece of what is open, for a tracker that will have to go on with it; nullopt when there is nothing new.
  std::optional<UnfinishedTrace> take_unfinished_trace();
  std::optional<UnfinishedSitting> take_unfinished_sitting();
  /// Of the newest frame.
  [[nodiscard]] SinceKeyPose since_key_pose() const;

  [[nodiscard]] const TrackerStats& stats() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
