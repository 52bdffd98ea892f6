// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/smoothed_velocity.hpp"

namespace kinemap {

enum class Side { Left, Right };

/// Whether one hand lies on the hip of its side: elbow bent, hand at the iliac crest, hand at rest against the pelvis.
/// All inside the body, so no drift of the suit touches it.
class HandOnHip {
 public:
  HandOnHip(Side side, const TrackerConfig::Gesture& config);
  bool step(const SuitFrame& frame);
  void reset();

 private:
  [[nodiscard]] bool lies_on_hip(const SuitFrame& frame, double speed_mps) const;

  Side side_;
  TrackerConfig::Gesture config_;
  SmoothedVelocity velocity_;
  bool on_ = false;
};

/// The modelling gesture: the left hand on its hip and the right hand free. Both hands on the hips is a way to stand.
class GestureFold {
 public:
  explicit GestureFold(const TrackerConfig::Gesture& config) : left_(Side::Left, config), right_(Side::Right, config) {}
  bool step(const SuitFrame& frame);
  void reset();

 private:
  HandOnHip left_;
  HandOnHip right_;
};

}  // namespace kinemap
