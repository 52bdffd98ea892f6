// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/gesture.hpp"
#include "core/tracker/pivot.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

/// Records the right hand while the gesture lasts. For each frame: step(), then record() if open(). What comes of it is
/// a Trace, or a Pivot when the hand drew nothing but turned about one spot. Memory is bounded by max_contacts.
class TraceFold {
 public:
  TraceFold(const TrackerConfig::Traces& config, const TrackerConfig::Pivot& pivot) : config_(config), pivot_(pivot) {}

  /// Opens, keeps or ends the trace; returns one that has just ended and is long enough in time and space. It opens
  /// when the left hand comes near the hip, so that nothing of the right hand is missed, and is forgotten when the left
  /// hand does not stay.
  std::optional<Event> step(double time_s, const GestureState& gesture);
  /// Adds the right hand of this frame, if it moved or time passed. `latest` is the latest key pose, at or before the
  /// frame.
  void record(const SuitFrame& frame, const KeyPose& latest);
  /// The suit's world is another one: `T_odom_before` takes what was in the old one to the new one. The time that
  /// nobody saw the wearer counts as none.
  void move(const Pose& T_odom_before, double unseen_s);
  /// Whether the right hand of an open trace is still where it was, if the suit's world was moved so.
  [[nodiscard]] bool waited(const Pose& T_odom_before, const SuitFrame& frame) const;
  /// Ends an open trace (end of the stream, discontinuity).
  std::optional<Event> close();
  /// What was added to an open trace since the last call, if anything was; `hips` is the gesture's.
  std::optional<UnfinishedTrace> take_unfinished(const std::array<HipState, 2>& hips);
  /// Before the first frame: goes on with the trace of another fold, if one was open.
  void resume(const Interrupted& before);

  [[nodiscard]] bool open() const { return open_; }
  /// Open, and by now it is sure that the gesture is meant.
  [[nodiscard]] bool held() const { return open_ && held_; }
  /// Open, and nothing has been recorded yet: the first contact wants a key pose of its own.
  [[nodiscard]] bool starting() const { return open_ && trace_.contacts.empty(); }
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }
  [[nodiscard]] std::uint64_t thinned_out() const { return thinned_out_; }

 private:
  void keep(const HandContact& contact, const Pose& T_odom_hand);
  void stretch(const Eigen::Vector3d& wrist);

  TrackerConfig::Traces config_;
  TrackerConfig::Pivot pivot_;
  bool open_ = false;
  bool held_ = false;  ///< the gesture has been held during this trace
  Trace trace_;
  std::vector<HandSample> hand_;  ///< the trace's contacts in the odom frame
  double seen_s_ = 0.0;           ///< last frame with the gesture
  double extent_m_ = 0.0;  ///< a lower bound (≥ half) of the wrist's farthest two places while the gesture was seen
  Eigen::Vector3d first_wrist_ = Eigen::Vector3d::Zero();     ///< odom frame
  Eigen::Vector3d farthest_wrist_ = Eigen::Vector3d::Zero();  ///< from the first one, odom frame
  Pose kept_;                                                 ///< T_odom_hand of the last kept contact
  double kept_s_ = 0.0;
  std::size_t told_ = 0;  ///< so many contacts take_unfinished() has given away
  std::array<HipState, 2> told_hips_;
  std::uint64_t rejected_ = 0;
  std::uint64_t thinned_out_ = 0;
};

}  // namespace kinemap
