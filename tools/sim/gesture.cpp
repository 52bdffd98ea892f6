// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/gesture.hpp"

namespace kinemap::sim {

namespace {

constexpr double kBodyClear = 0.26;  ///< pelvis to anything, m

}  // namespace

Gesture accompany(Composer& composer, const std::vector<ContourSample>& samples, const Stance& stance) {
  const double rate = composer.score().rate_hz;
  std::vector<Vec2> hand, outward;
  for (const auto& s : samples) {
    hand.push_back(s.p.head<2>());
    outward.push_back(s.outward.head<2>());
  }
  smooth_samples(hand, stance.follow_s * rate);
  smooth_samples(outward, 0.65 * rate);
  Gesture gesture;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2 n = outward[i].normalized();
    const double heading = heading_of(-n) + stance.face_turn;
    const Vec2 aside = left_of(direction(heading)) * stance.to_left - left_of(-n) * stance.lag;
    gesture.ground.push_back(
        composer.planner().pushed_clear(hand[i] + n * stance.standoff + aside, hand[i] + n * 0.35, kBodyClear));
    gesture.heading.push_back(heading);
  }
  smooth_samples(gesture.ground, 0.2 * rate);
  return gesture;
}

bool perform(Composer& composer, const Gesture& gesture, int object) {
  if (!composer.walk_to(gesture.ground.front(), gesture.heading.front())) return false;
  const double begin = composer.now();
  const double contact = composer.begin_gesture();
  composer.score().touches.push_back({composer.score().frames(), gesture.touch});
  composer.follow(gesture.ground, gesture.heading);
  const double contact_end = composer.now();
  composer.end_gesture();
  composer.label({begin, composer.now(), "trace", object, contact, contact_end});
  return true;
}

}  // namespace kinemap::sim
