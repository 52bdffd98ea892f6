// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/performer.hpp"

namespace kinemap::sim {

namespace {

constexpr double kStraight = 0.985;  ///< part of its length to which a standing leg is stretched
constexpr double kArmReach = 0.93;   ///< part of the arm's length beyond which one leans instead
constexpr double kMaxLean = 1.15;    ///< rad

double time_of(const Score& score, std::size_t frame) { return static_cast<double>(frame) / score.rate_hz; }

/// Largest value within ± `half` samples.
std::vector<double> spread_max(const std::vector<double>& values, std::size_t half) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t a = i > half ? i - half : 0, b = std::min(values.size(), i + half + 1);
    out[i] = *std::max_element(values.begin() + static_cast<long>(a), values.begin() + static_cast<long>(b));
  }
  return out;
}

/// From a to b; when they are nearly opposite, where the shortest turn is ambiguous, by way of `middle`.
Quat between(const Quat& a, const Quat& middle, const Quat& b, double w) {
  const double detour = smooth_step((a.angularDistance(b) - 1.7) / 0.8);
  const Quat direct = a.slerp(w, b);
  return detour > 0.0 ? direct.slerp(detour, a.slerp(w, middle).slerp(w, middle.slerp(w, b))) : direct;
}

}  // namespace

Performer::Performer(const Score& score, const Gait& gait, const Wearer& wearer, Random& random)
    : score_(score), gait_(gait), wearer_(wearer), trunk_(score.frames()) {
  plan_sway(random);
  plan_reach();
  plan_height();
}

const TouchPoint& Performer::touch_at(const ArmGoal& goal, std::size_t frame) const {
  const TouchRun& run = score_.touches[goal.touch];
  return run.points[std::clamp(frame, run.first, run.first + run.points.size() - 1) - run.first];
}

void Performer::plan_sway(Random& random) {
  std::vector<double> weight(frames());
  std::vector<double> tempo(frames());
  std::vector<Vec2> idle(frames());
  Wander x(0.004, 1.5, random), y(0.005, 1.8, random);
  const auto window = static_cast<std::size_t>(0.5 * score_.rate_hz);
  for (std::size_t i = 0; i < frames(); ++i) {
    const bool right = gait_.feet[0][i].planted, left = gait_.feet[1][i].planted;
    weight[i] = right == left ? 0.0 : left ? 1.0 : -1.0;
    const std::size_t a = i > window ? i - window : 0, b = std::min(frames() - 1, i + window);
    tempo[i] =
        std::min(1.0, (score_.ground[b] - score_.ground[a]).norm() / (static_cast<double>(b - a) / score_.rate_hz));
    idle[i] = Vec2(x.step(1.0 / score_.rate_hz, random), y.step(1.0 / score_.rate_hz, random));
  }
  smooth_samples(weight, 0.14 * score_.rate_hz);
  smooth_samples(idle, 0.2 * score_.rate_hz);
  for (std::size_t i = 0; i < frames(); ++i) {
    Trunk& t = trunk_[i];
    t.tempo = tempo[i];
    t.sway = left_of(direction(score_.heading[i])) * 0.022 * weight[i] + idle[i];
    t.swing_roll = 0.04 * weight[i] * tempo[i];
    // The pelvis turns with the leg that is in front.
    const Vec2 forward = direction(score_.heading[i]);
    const Vec3 apart = ankle(Side::Left, i) - ankle(Side::Right, i);
    t.swing_yaw = -0.16 * std::clamp(apart.x() * forward.x() + apart.y() * forward.y(), -0.5, 0.5) * tempo[i];
  }
}

void Performer::plan_reach() {
  const double stand = wearer_.body.ankle_height + kStraight * (wearer_.body.hip_height() - wearer_.body.ankle_height);
  std::vector<double> lean(frames(), 0.0), twist(frames(), 0.0);
  for (std::size_t i = 0; i < frames(); ++i) {
    const double t = time_of(score_, i);
    trunk_[i].height = stand - score_.drop.at(t);
    trunk_[i].twist = score_.twist.at(t);
    lean[i] = 0.03 + score_.lean.at(t);
    const auto arm = score_.right.at(t);
    if (arm.to->anchor != ArmGoal::Anchor::Touch) continue;
    const TouchPoint& touch = touch_at(*arm.to, i);
    const Vec3 d = touch.p - lift(score_.ground[i], 0);
    const double bearing = wrapped(std::atan2(d.y(), d.x()) - score_.heading[i]);
    twist[i] = arm.weight * std::clamp(0.5 * (bearing + 0.35), -0.5, 0.5);
    lean[i] = std::max(lean[i], arm.weight * needed_lean(touch, i));
  }
  smooth_samples(twist, 0.3 * score_.rate_hz);
  lean = spread_max(lean, static_cast<std::size_t>(0.3 * score_.rate_hz));
  smooth_samples(lean, 0.18 * score_.rate_hz);
  for (std::size_t i = 0; i < frames(); ++i) {
    trunk_[i].lean = lean[i];
    trunk_[i].twist += twist[i];
  }
}

double Performer::needed_lean(const TouchPoint& touch, std::size_t frame) const {
  const double reach = kArmReach * (wearer_.body.upper_arm(Side::Right) + wearer_.body.forearm(Side::Right));
  const auto missing = [&](double lean) {
    Pose23 pose;
    place_trunk(pose, frame, lean, trunk_[frame].twist);
    place_chain(wearer_.body, pose, kRightShoulder, kRightUpperArm);
    const Vec3 shoulder = pose[kRightUpperArm].p;
    return (aim_for_touch(touch, shoulder).wrist - shoulder).norm() - reach;
  };
  if (missing(0.03) <= 0.0) return 0.03;
  double low = 0.03, high = kMaxLean;
  for (int i = 0; i < 9; ++i) {
    const double middle = (low + high) / 2;
    (missing(middle) > 0.0 ? low : high) = middle;
  }
  return high;
}

void Performer::plan_height() {
  const Body& body = wearer_.body;
  const double leg = 0.995 * (body.hip_height() - body.ankle_height);
  std::vector<double> limit(frames()), height(frames());
  for (std::size_t i = 0; i < frames(); ++i) {
    limit[i] = trunk_[i].height;
    height[i] = limit[i];
    if (score_.kneel.at(time_of(score_, i)) > 0.0) continue;
    Pose23 pose;
    place_trunk(pose, i, trunk_[i].lean, trunk_[i].twist);
    for (const Side side : {Side::Right, Side::Left}) {
      const Bone thigh = side == Side::Right ? kRightUpperLeg : kLeftUpperLeg;
      const Vec3 hip = pose[kPelvis].q * body.offset[thigh];
      const Vec3 d = ankle(side, i) - pose[kPelvis].p - hip;
      const double up2 = leg * leg - d.x() * d.x() - d.y() * d.y();
      limit[i] = std::min(limit[i], ankle(side, i).z() + std::sqrt(std::max(up2, 0.2 * leg * leg)) - hip.z());
    }
    height[i] = limit[i];
  }
  smooth_samples(height, 0.05 * score_.rate_hz);
  for (std::size_t i = 0; i < frames(); ++i) trunk_[i].height = std::min(height[i], limit[i]);
}

Vec3 Performer::ankle(Side side, std::size_t frame) const {
  const FootState& foot = gait_.feet[side == Side::Left ? 1 : 0][frame];
  const Vec3& to_ball = wearer_.body.offset[side == Side::Left ? kLeftToe : kRightToe];
  return foot.ball - about_z(foot.heading) * (about_y(foot.pitch) * to_ball);
}

void Performer::place_trunk(Pose23& pose, std::size_t i, double lean, double twist) const {
  const double t = time_of(score_, i);
  const Trunk& trunk = trunk_[i];
  // Bending forward, the hips go back, or one would fall.
  const double shift = score_.shift.at(t) - 0.10 * std::sin(std::max(0.0, lean - 0.03));
  const double heading = score_.heading[i];
  pose[kPelvis].p = lift(score_.ground[i] + direction(heading) * shift + trunk.sway, trunk.height);
  pose[kPelvis].q =
      about_z(heading + trunk.swing_yaw) * about_y(score_.pelvis_pitch.at(t) + 0.4 * lean) * about_x(trunk.swing_roll);
  const Quat chest = about_z(heading + twist - 0.6 * trunk.swing_yaw) * about_y(lean);
  const Quat head = about_z(heading + 1.1 * twist) * about_y(0.08 + 0.5 * lean);
  pose[kL5].q = pose[kPelvis].q.slerp(0.3, chest);
  pose[kL3].q = pose[kPelvis].q.slerp(0.55, chest);
  pose[kT12].q = pose[kPelvis].q.slerp(0.8, chest);
  pose[kT8].q = chest;
  pose[kNeck].q = chest.slerp(0.5, head);
  pose[kHead].q = head;
  pose[kRightShoulder].q = pose[kLeftShoulder].q = chest;
  place_chain(wearer_.body, pose, kL5, kHead);
}

Performer::ArmAim Performer::aim_for_touch(const TouchPoint& touch, const Vec3& shoulder) const {
  // Fingers point partly where they should and partly where the arm points anyway; a flat palm has no choice.
  // The farther the reach, the straighter wrist and arm.
  const double arm = wearer_.body.upper_arm(Side::Right) + wearer_.body.forearm(Side::Right);
  const double stretch = (touch.p - shoulder).norm() / (arm - wearer_.p_hand_touch.y());
  const double own = (wearer_.palm ? 0.0 : 0.45) + (wearer_.palm ? 0.95 : 0.5) * smooth_step((stretch - 0.72) / 0.22);
  const Vec3 fingers = (1.0 - own) * touch.fingers + own * (touch.p - shoulder).normalized();
  const Quat hand = hand_orientation(Side::Right, fingers, touch.palm);
  return {touch.p - hand * wearer_.p_hand_touch, Vec3::Zero(), hand};
}

Performer::ArmAim Performer::aim(const Pose23& pose, Side side, const ArmGoal& goal, std::size_t frame) const {
  const Vec3 shoulder = pose[side == Side::Right ? kRightUpperArm : kLeftUpperArm].p;
  const Quat upright = about_z(heading_of(Vec2((pose[kT8].q * Vec3::UnitX()).head<2>())));
  Placed anchor;
  switch (goal.anchor) {
    case ArmGoal::Anchor::Shoulder:
      anchor = {shoulder, upright};
      break;
    case ArmGoal::Anchor::Pelvis:
      anchor = pose[kPelvis];
      break;
    case ArmGoal::Anchor::Chest:
      anchor = pose[kT8];
      break;
    case ArmGoal::Anchor::Head:
      anchor = pose[kHead];
      break;
    case ArmGoal::Anchor::Ground:
      anchor = {pose[kPelvis].p, about_z(score_.heading[frame])};
      break;
    case ArmGoal::Anchor::World:
      anchor = {Vec3::Zero(), Quat::Identity()};
      break;
    case ArmGoal::Anchor::Touch: {
      ArmAim touch = aim_for_touch(touch_at(goal, frame), shoulder);
      // Elbow out and down; behind the body where that is just where the hand reaches.
      const double same = (upright.conjugate() * (touch.wrist - shoulder)).normalized().dot(goal.elbow.normalized());
      touch.elbow = upright * (goal.elbow + smooth_step((same - 0.3) / 0.5) * Vec3(-1.0, 0.6, 0.2));
      return touch;
    }
  }
  Quat swing = Quat::Identity();
  if (goal.swing > 0.0) {
    // Arms swing against the legs of their side.
    const Vec3 apart = ankle(Side::Left, frame) - ankle(Side::Right, frame);
    const double stride = about_z(-score_.heading[frame]).operator*(apart).x();
    swing = about_y(goal.swing * lateral(side) * 0.6 * std::clamp(stride, -0.6, 0.6) * trunk_[frame].tempo);
  }
  const Quat q = anchor.q * swing;
  return {anchor.p + q * goal.wrist, anchor.q * goal.elbow, hand_orientation(side, q * goal.fingers, q * goal.palm)};
}

void Performer::place_arm(Pose23& pose, Side side, std::size_t frame) const {
  const Body& body = wearer_.body;
  const std::size_t upper = side == Side::Right ? kRightUpperArm : kLeftUpperArm;
  const auto blend = (side == Side::Right ? score_.right : score_.left).at(time_of(score_, frame));
  place_chain(body, pose, upper - 1, upper);
  const ArmAim to = aim(pose, side, *blend.to, frame);
  solve_arm(body, pose, side, to.wrist, to.elbow, to.hand);
  if (blend.weight >= 1.0) return;
  // From one posture to the next each joint turns steadily: the hand goes in an arc, as hands do.
  Pose23 before = pose;
  const ArmAim from = aim(pose, side, *blend.from, frame);
  solve_arm(body, before, side, from.wrist, from.elbow, from.hand);
  const Quat chest = pose[kT8].q, chest_back = chest.conjugate();
  const double w = blend.weight, s = lateral(side);
  // Elbow a little out and bent forward: a posture from which every other one is reached without a detour.
  const Vec3 u(0.35, 0.45 * s, -0.8), f(1, 0, 0.2);
  const Quat neutral = hand_orientation(side, u, s * u.cross(f));
  const Quat arm = between(chest_back * before[upper].q, neutral, chest_back * pose[upper].q, w);
  const Quat elbow =
      (before[upper].q.conjugate() * before[upper + 1].q).slerp(w, pose[upper].q.conjugate() * pose[upper + 1].q);
  const Quat hand_from = chest_back * before[upper + 2].q, hand_to = chest_back * pose[upper + 2].q;
  pose[upper].q = (chest * arm).normalized();
  pose[upper + 1].q = (pose[upper].q * elbow).normalized();
  pose[upper + 2].q = (chest * between(hand_from, chest_back * pose[upper + 1].q, hand_to, w)).normalized();
  place_chain(body, pose, upper, upper + 2);
}

void Performer::place_leg(Pose23& pose, Side side, std::size_t frame) const {
  const FootState& foot = gait_.feet[side == Side::Left ? 1 : 0][frame];
  const std::size_t bone = side == Side::Left ? kLeftFoot : kRightFoot;
  const double kneel = score_.kneel.at(time_of(score_, frame));
  const Quat level = about_z(score_.heading[frame]);
  Vec3 target = ankle(side, frame);
  Quat orientation = about_z(foot.heading) * about_y(foot.pitch);
  const Vec3 forward = level * Vec3(1.0, 0.12 * lateral(side), 0.35);
  if (kneel > 0.0) {  // shank on the floor behind, toes bent
    const Vec3 hip =
        pose[kPelvis].p + pose[kPelvis].q * wearer_.body.offset[side == Side::Left ? kLeftUpperLeg : kRightUpperLeg];
    const Vec3 behind = level * Vec3(-0.97 * wearer_.body.shank(side), 0, 0);
    target = target * (1.0 - kneel) + Vec3(hip.x() + behind.x(), hip.y() + behind.y(), 0.09) * kneel;
    orientation = orientation.slerp(kneel, level * about_y(1.2));
  }
  solve_leg(wearer_.body, pose, side, target, forward);
  pose[bone].q = orientation;
  // The toes stay flat while the heel rises.
  pose[bone + 1].q = foot.planted && kneel == 0.0 ? about_z(foot.heading) : orientation;
  place_chain(wearer_.body, pose, bone, bone + 1);
}

Vec3 Performer::pelvis(std::size_t frame) const {
  Pose23 pose;
  place_trunk(pose, frame, trunk_[frame].lean, trunk_[frame].twist);
  return pose[kPelvis].p;
}

Pose23 Performer::pose(std::size_t frame) const {
  Pose23 pose;
  place_trunk(pose, frame, trunk_[frame].lean, trunk_[frame].twist);
  place_arm(pose, Side::Right, frame);
  place_arm(pose, Side::Left, frame);
  place_leg(pose, Side::Right, frame);
  place_leg(pose, Side::Left, frame);
  return pose;
}

}  // namespace kinemap::sim
