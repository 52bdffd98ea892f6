// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/smoothed_velocity.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

enum class Side { Left, Right };

/// What the gesture says of one frame.
struct GestureState {
  bool near = false;  ///< the left hand is near its hip, the right one not held on its own
  bool held = false;  ///< … and has come to rest there
  /// Both hands rest on the hips, the right one since this stream time: from then on it was no gesture, as is only
  /// known now.
  std::optional<double> both_since_s;
};

/// Whether one hand lies on the hip of its side: elbow bent, hand at the iliac crest, hand at rest against the pelvis.
/// All inside the body, so no drift of the suit touches it.
class HandOnHip {
 public:
  HandOnHip(Side side, const TrackerConfig::Gesture& config);
  HipState step(const SuitFrame& frame);
  void reset();
  void resume(const HipState& state) { state_ = state; }
  [[nodiscard]] const HipState& state() const { return state_; }

 private:
  [[nodiscard]] bool is_near(const SuitFrame& frame) const;

  Side side_;
  TrackerConfig::Gesture config_;
  SmoothedSpeed speed_;
  HipState state_;
};

/// The modelling gesture: the left hand on its hip and the right hand free. Both hands on the hips is a way to stand.
class GestureFold {
 public:
  explicit GestureFold(const TrackerConfig::Gesture& config);
  GestureState step(const SuitFrame& frame);
  void reset();
  void resume(const std::array<HipState, 2>& hips);
  /// Left, right.
  [[nodiscard]] std::array<HipState, 2> hips() const { return {left_.state(), right_.state()}; }

 private:
  HandOnHip left_;
  HandOnHip right_;
};

}  // namespace kinemap
