// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/sim/geometry.hpp"

namespace kinemap::sim {

/// A value that moves smoothly from one key to the next.
class Track {
 public:
  explicit Track(double value = 0.0) : start_(value) {}
  /// From `begin_s` on (not before the last key's end) go to `value`, there at `end_s`.
  void to(double begin_s, double end_s, double value);
  [[nodiscard]] double at(double time_s) const;

 private:
  struct Key {
    double begin_s, end_s, value;
  };
  double start_;
  std::vector<Key> keys_;
};

/// Where a hand is held. Points and directions are given in the anchor's frame.
struct ArmGoal {
  enum class Anchor : std::uint8_t {
    Shoulder,  ///< origin: the shoulder joint; axes: upright, heading of the chest. Hands hang here
    Pelvis,    ///< the pelvis segment
    Chest,     ///< T8
    Head,      ///< the head segment
    Ground,    ///< origin: the pelvis; axes: upright, heading of the pelvis
    World,
    Touch,  ///< the hand's touching point follows the score's touches
  };
  Anchor anchor = Anchor::Shoulder;
  Vec3 wrist = Vec3::Zero();
  Vec3 elbow{-1, 0, 0};    ///< direction towards which the elbow points
  Vec3 fingers{0, 0, -1};  ///< direction of the fingers
  Vec3 palm{0, 0, -1};     ///< direction that the palm faces
  double swing = 0.0;      ///< 1: swings with the gait
  std::size_t touch = 0;   ///< Anchor::Touch: which of the score's touches
};

/// A hand's goals over time.
class ArmTrack {
 public:
  explicit ArmTrack(const ArmGoal& start) : goals_{start} {}
  void to(double begin_s, double end_s, const ArmGoal& goal);

  struct Blend {
    const ArmGoal* from;
    const ArmGoal* to;
    double weight;  ///< of `to`
  };
  [[nodiscard]] Blend at(double time_s) const;
  [[nodiscard]] double last_end() const { return keys_.empty() ? 0.0 : keys_.back().end_s; }

 private:
  struct Key {
    double begin_s, end_s;
    std::size_t goal;
  };
  std::vector<ArmGoal> goals_;
  std::vector<Key> keys_;
};

/// What the right hand touches at one instant.
struct TouchPoint {
  Vec3 p;        ///< world, m
  Vec3 fingers;  ///< preferred direction of the fingers
  Vec3 palm;     ///< preferred direction of the palm
};
struct TouchRun {
  std::size_t first = 0;  ///< frame
  std::vector<TouchPoint> points;
};

/// A labelled stretch of the session.
struct Interval {
  double begin_s = 0.0, end_s = 0.0;
  std::string label;                                    ///< "trace", "sit", "walk", "distractor:…"
  int object = 0;                                       ///< 0: none
  double contact_begin_s = -1.0, contact_end_s = -1.0;  ///< right hand on the object, or seated
  int gesture = 0;                                      ///< which gesture, from 1; objects drawn in one share it
  int part = 1, parts = 1;                              ///< of an object that is drawn in several gestures
  std::vector<std::pair<double, double>> lift_offs{};   ///< the hand is off the surface, s
};

/// All that the wearer means to do, before feet and joints: where the body goes and where the hands are. Building's
/// frame.
struct Score {
  Score(double rate, const ArmGoal& right_hang, const ArmGoal& left_hang)
      : rate_hz(rate), right(right_hang), left(left_hang) {}

  double rate_hz;
  std::vector<Vec2> ground;     ///< per frame: the point of the floor that the feet stand around
  std::vector<double> heading;  ///< per frame, rad, unwrapped
  Track shift;                  ///< pelvis forward of the ground point, m
  Track drop;                   ///< pelvis below standing height, m
  Track pelvis_pitch;           ///< forward positive, rad
  Track lean;                   ///< least forward lean of the chest, rad
  Track twist;                  ///< chest heading relative to the pelvis, rad
  Track kneel;                  ///< 1: both shanks on the floor behind
  ArmTrack right, left;
  std::vector<TouchRun> touches;
  std::vector<Interval> intervals;

  [[nodiscard]] double now() const { return static_cast<double>(ground.size()) / rate_hz; }
  [[nodiscard]] std::size_t frames() const { return ground.size(); }
};

}  // namespace kinemap::sim
