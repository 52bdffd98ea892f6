// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

#include "core/body.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/smoothed_velocity.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

enum class Side { Left, Right };

/// What the gesture says of one frame.
struct GestureState {
  bool near = false;  ///< the left hand is near its hip, the right one free to draw
  bool held = false;  ///< … and has come to rest there
  /// The right hand rests on its own hip, or hangs beside the body, since this stream time: from then on it was no
  /// gesture, as is only known now.
  std::optional<double> none_since_s;
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

/// Whether the right arm hangs beside the body, swinging as the wearer walks or at rest where one stands. Many put the
/// left hand on the hip while they still walk up or think, or leave it there on the way to the next thing: what the
/// right one does then draws nothing. A hand that follows a wall or an edge stays where it is beside the body however
/// fast one walks, and moves when one stands.
class HangingArm {
 public:
  explicit HangingArm(const TrackerConfig::Gesture& config) : config_(config) {}
  /// While it hangs so, and has for long enough to be sure: since which stream time. At rest it hangs for everybody;
  /// that counts only while the left hand is at its hip.
  std::optional<double> step(const SuitFrame& frame, bool left_near);
  void reset();

 private:
  struct Sample {
    double time_s;
    Eigen::Vector2d p_odom_pelvis;
    double forward_m;  ///< of the wrist before the shoulder, as the pelvis faces
  };
  struct Rest {
    double since_s;
    Eigen::Vector3d p_odom_pelvis, p_pelvis_wrist;
    bool long_enough;
  };
  /// Over the last second, at the newest of the samples.
  [[nodiscard]] bool swings() const;
  std::optional<double> rested(const SuitFrame& frame, bool hangs);

  TrackerConfig::Gesture config_;
  std::deque<Sample> samples_;
  std::optional<Rest> rest_;
  std::optional<double> swings_since_s_;
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
  HangingArm hanging_;
};

}  // namespace kinemap
