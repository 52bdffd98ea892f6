// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/postures.hpp"

namespace kinemap::sim::postures {

namespace {

using Anchor = ArmGoal::Anchor;

/// A goal written for the left side of somebody 1.75 m tall, for `side` of this wearer.
ArmGoal goal(const Wearer& wearer, Side side, Anchor anchor, const Vec3& wrist, const Vec3& elbow, const Vec3& fingers,
             const Vec3& palm) {
  const Vec3 mirror(1, lateral(side), 1);
  ArmGoal g;
  g.anchor = anchor;
  g.wrist = wrist.cwiseProduct(mirror) * (wearer.body.stature / 1.75);
  g.elbow = elbow.cwiseProduct(mirror);
  g.fingers = fingers.cwiseProduct(mirror);
  g.palm = palm.cwiseProduct(mirror);
  return g;
}

}  // namespace

ArmGoal hanging(const Wearer& wearer, Side side) {
  const double reach = 0.985 * (wearer.body.upper_arm(side) + wearer.body.forearm(side));
  ArmGoal g = goal(wearer, side, Anchor::Shoulder, Vec3::Zero(), {-1, 0.25, 0}, {0.15, 0, -1}, {0.1, -1, 0});
  g.wrist = Vec3(0.07, 0.09 * lateral(side), -1).normalized() * reach;
  g.swing = 1.0;
  return g;
}

ArmGoal on_hip(const Wearer& wearer, Side side, const HipStyle& style) {
  const Body& b = wearer.body;
  const double a = b.upper_arm(side), f = b.forearm(side);
  const double distance = std::sqrt(a * a + f * f - 2 * a * f * std::cos(style.elbow_angle));
  // The shoulder over the pelvis, upright.
  const Vec3 shoulder = b.offset[kL5] + b.offset[kL3] + b.offset[kT12] + b.offset[kT8] + b.offset[kLeftShoulder] +
                        b.offset[kLeftUpperArm];
  ArmGoal g = goal(wearer, side, Anchor::Pelvis, Vec3::Zero(), style.elbow, style.fingers, style.palm);
  const Vec2 level(-0.02 + style.offset.x(), 0.165 * b.stature / 1.75 + style.offset.y());
  const double across = (Vec2(shoulder.x(), shoulder.y()) - level).norm();
  const double down = std::sqrt(std::max(0.0, distance * distance - across * across));
  g.wrist = Vec3(level.x(), level.y() * lateral(side), shoulder.z() - down);
  return g;
}

ArmGoal phone_at_ear(const Wearer& w, Side s) {
  return goal(w, s, Anchor::Head, {0.05, 0.12, -0.05}, {0.3, 0.5, -1.0}, {-0.25, -0.1, 1.0}, {0, -1, 0.1});
}
ArmGoal crossed(const Wearer& w, Side s) {
  const double nearer = s == Side::Left ? 0.03 : 0.0;  // one forearm lies on the other
  return goal(w, s, Anchor::Chest, {0.17 + nearer, -0.05, -0.06 - nearer}, {0.2, 0.7, -1.0}, {0.15, -1, 0.1},
              {-1, 0, -0.2});
}
ArmGoal in_the_air(const Wearer& w, Side s) {
  return goal(w, s, Anchor::Shoulder, {0.10, 0.14, 0.47}, {0.2, 1.0, 0.1}, {0, 0.1, 1}, {1, 0, 0});
}
ArmGoal scratching_head(const Wearer& w, Side s) {
  return goal(w, s, Anchor::Head, {0.0, 0.17, 0.13}, {0.4, 1.0, 0.1}, {-0.2, -1, 0.35}, {-0.3, -0.4, -1});
}
ArmGoal on_thigh(const Wearer& w, Side s) {
  return goal(w, s, Anchor::Ground, {0.27, 0.16, 0.09}, {-0.7, 0.8, -0.3}, {1, -0.2, -0.15}, {0, 0, -1});
}

ArmGoal touching(std::size_t touch) {
  ArmGoal g;
  g.anchor = Anchor::Touch;
  g.elbow = {-0.15, -0.7, -0.7};
  g.touch = touch;
  return g;
}

ArmGoal against(const Wearer& wearer, const Vec3& p, const Vec3& n) {
  ArmGoal g;
  g.anchor = Anchor::World;
  g.wrist = p + n * 0.04 - Vec3::UnitZ() * 0.05 * wearer.body.stature;
  g.elbow = {0, 0, -1};
  g.fingers = {0, 0, 1};
  g.palm = -n;
  return g;
}

ArmGoal reaching_down(const Wearer& wearer, const Vec3& p) {
  ArmGoal g;
  g.anchor = Anchor::World;
  g.wrist = p + Vec3::UnitZ() * 0.1 * wearer.body.stature;
  g.elbow = {-0.5, -0.8, 0.2};
  g.fingers = {0, 0, -1};
  g.palm = {0, 1, 0};
  return g;
}

}  // namespace kinemap::sim::postures
