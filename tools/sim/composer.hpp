// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tools/sim/planner.hpp"
#include "tools/sim/postures.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/score.hpp"
#include "tools/sim/wearer.hpp"

namespace kinemap::sim {

/// Writes the score: each call goes on in time from where the one before ended.
class Composer {
 public:
  Composer(const SimOptions& options, const Building& building, const Wearer& wearer, Random& random);

  /// The first frame: stands here.
  void follow_from(const Vec2& ground, double heading) { push(ground, heading); }
  void stand(double seconds);
  /// Turns on the spot to a heading.
  void turn_to(double heading);
  /// Walks there round the furniture and turns to `heading`. False (nothing written) when there is no way.
  bool walk_to(const Vec2& goal, std::optional<double> heading);
  /// Appends a given motion of the body over the floor; headings are unwrapped here.
  void follow(const std::vector<Vec2>& ground, const std::vector<double>& heading);
  /// Begins a gesture: left hand to the hip, perhaps while still on the way, then the right one to the first point of
  /// the touch that is added next. When the left hand sets out, and when the right one arrives.
  struct Lead {
    double begin_s, contact_s;
  };
  Lead begin_gesture();
  /// The right hand goes to the first point of the touch that is added next; there at the earliest at `earliest_s`.
  /// Stands until then; returns when.
  double reach_out(double earliest_s);
  /// Ends it at now: the right hand leaves, then the left one (or nearly at once). Returns when the left one sets out
  /// or the right one has left, whichever is later.
  double end_gesture();
  [[nodiscard]] int gestures() const { return gestures_; }  ///< begun so far
  void label(const Interval& interval) { score_.intervals.push_back(interval); }

  [[nodiscard]] double now() const { return score_.now(); }
  [[nodiscard]] double walked() const { return walked_; }  ///< metres since the beginning
  [[nodiscard]] const Vec2& position() const { return score_.ground.back(); }
  [[nodiscard]] double heading() const { return score_.heading.back(); }
  [[nodiscard]] std::size_t frames(double seconds) const {
    return static_cast<std::size_t>(std::lround(seconds * score_.rate_hz));
  }

  Score& score() { return score_; }
  Random& random() { return random_; }
  [[nodiscard]] const Planner& planner() const { return planner_; }
  [[nodiscard]] const Wearer& wearer() const { return wearer_; }
  [[nodiscard]] const Building& building() const { return building_; }
  [[nodiscard]] double speed_factor() const { return speed_; }
  [[nodiscard]] ArmGoal hang(Side side) const { return postures::hanging(wearer_, side); }
  ArmGoal hip_goal();  ///< the left hand on the hip, as in the next gesture

 private:
  void push(const Vec2& ground, double heading);

  const Building& building_;
  Planner planner_;
  const Wearer& wearer_;
  Random& random_;
  double speed_;
  Score score_;
  double walked_ = 0.0;
  int gestures_ = 0;
};

}  // namespace kinemap::sim
