// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/smoothed_velocity.hpp"

namespace kinemap {

enum class Side { Left, Right };

/// `held` implies `near`. A hand is near as soon as the arm has the shape of the gesture, and held once it has rested
/// there.
struct HipState {
  bool near = false;
  bool held = false;
};

/// Whether one hand lies on the hip of its side: elbow bent, hand at the iliac crest, hand at rest against the pelvis.
/// All inside the body, so no drift of the suit touches it.
class HandOnHip {
 public:
  HandOnHip(Side side, const TrackerConfig::Gesture& config);
  HipState step(const SuitFrame& frame);
  void reset();

 private:
  [[nodiscard]] bool is_near(const SuitFrame& frame) const;

  Side side_;
  TrackerConfig::Gesture config_;
  SmoothedSpeed speed_;
  HipState state_;
  double moved_s_ = 0.0;  ///< when the hand last moved or was not near
};

/// The modelling gesture: the left hand on its hip and the right hand free. Both hands on the hips is a way to stand.
class GestureFold {
 public:
  explicit GestureFold(const TrackerConfig::Gesture& config) : left_(Side::Left, config), right_(Side::Right, config) {}
  HipState step(const SuitFrame& frame);
  void reset();

 private:
  HandOnHip left_;
  HandOnHip right_;
};

}  // namespace kinemap
