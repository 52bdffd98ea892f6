// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/suit.hpp"

namespace kinemap::sim {

namespace {

constexpr double kTiltTau_s = 12.0;
constexpr double kArmTau_s = 3.0;
constexpr double kJitterTau_s = 1.5;

std::vector<Vec2> level_way(const Performer& performer) {
  std::vector<Vec2> way(performer.frames());
  for (std::size_t i = 0; i < way.size(); ++i) way[i] = performer.pelvis(i).head<2>();
  return way;
}

}  // namespace

Suit::Suit(const Wearer& wearer, const Score& score, const Gait& gait, const Performer& performer,
           const Building& building, const DriftColumn& column, bool hold_feet, Random& random)
    : wearer_(wearer),
      score_(score),
      gait_(gait),
      column_(column),
      random_(random),
      body_(mismeasured(wearer.body, column.body_scale, random)),
      patches_(draw_patches(building, column, random)),
      true_pelvis_(level_way(performer)),
      tilt_{Wander(radians(column.tilt_limit_deg) / 2.5, kTiltTau_s, random),
            Wander(radians(column.tilt_limit_deg) / 2.5, kTiltTau_s, random)},
      arms_{make_arm(random), make_arm(random)} {
  slip_ = make_slip(true_pelvis_, score, gait, column, patches_, random);
  if (!hold_feet) legs_ = std::array{make_leg(random), make_leg(random)};
}

Suit::Leg Suit::make_leg(Random& random) const {
  // Legs carry their weight and err by a quarter of what arms do, along a chain of about a metre.
  const double sigma = 0.25 * radians(column_.arm_deg);
  return {Wander(sigma, kArmTau_s, random), Wander(sigma, kArmTau_s, random), Wander(sigma, kArmTau_s, random)};
}

Suit::Arm Suit::make_arm(Random& random) const {
  // The table's figure is the size of the whole rotation: a third of the variance on each axis.
  const double sigma = radians(column_.arm_deg) / std::sqrt(3.0);
  Arm arm;
  for (int i = 0; i < 9; ++i) arm.joints.emplace_back(sigma, kArmTau_s, random);
  for (int i = 0; i < 3; ++i) arm.slow.emplace_back(column_.jitter_slow_m / std::sqrt(3.0), kJitterTau_s, random);
  return arm;
}

Pose23 Suit::report(std::size_t i, const Pose23& truth) {
  Pose23 out;
  report_trunk(i, truth, out);
  report_arm(Side::Right, i, truth, out);
  report_arm(Side::Left, i, truth, out);
  report_leg(Side::Right, i, truth, out);
  report_leg(Side::Left, i, truth, out);
  return out;
}

void Suit::report_trunk(std::size_t i, const Pose23& truth, Pose23& out) {
  const double limit = radians(column_.tilt_limit_deg), dt = 1.0 / score_.rate_hz;
  const double settle = std::min(1.0, static_cast<double>(i) * dt / 5.0);  // calibrated upright at the start
  const double roll = std::clamp(tilt_[0].step(dt, random_), -limit, limit),
               pitch = std::clamp(tilt_[1].step(dt, random_), -limit, limit);
  tilt_now_ = rotation(Vec3(roll, pitch, 0) * settle);
  const Quat wrong = tilt_now_ * about_z(slip_.heading[i]);
  for (std::size_t b = kPelvis; b <= kHead; ++b) out[b].q = (wrong * truth[b].q).normalized();
  out[kRightShoulder].q = out[kLeftShoulder].q = out[kT8].q;
  // Legs of wrong length carry the pelvis at a wrong height.
  const double legs =
      (body_.hip_height() - body_.ankle_height) / (wearer_.body.hip_height() - wearer_.body.ankle_height);
  const double z = body_.ankle_height + (truth[kPelvis].p.z() - wearer_.body.ankle_height) * legs + slip_.height[i];
  out[kPelvis].p = lift(slip_.pelvis[i], z);
  place_chain(body_, out, kL5, kHead);
}

void Suit::report_arm(Side side, std::size_t i, const Pose23& truth, Pose23& out) {
  const double dt = 1.0 / score_.rate_hz;
  Arm& arm = arms_[side == Side::Right ? 0 : 1];
  const std::size_t upper = side == Side::Right ? kRightUpperArm : kLeftUpperArm;
  // Beside metal the arm's own sensors go wrong as well, by what is there for them.
  const double pull = arm.pull.step(truth[upper + 2].p.head<2>(), patches_, dt) - slip_.magnetic[i];
  const Quat common = tilt_now_ * about_z(slip_.heading[i] + pull);
  Quat error = Quat::Identity();
  for (std::size_t joint = 0; joint < 3; ++joint) {
    Vec3 turn;
    for (std::size_t axis = 0; axis < 3; ++axis)
      turn[static_cast<long>(axis)] = arm.joints[3 * joint + axis].step(dt, random_);
    error = error * rotation(turn);
    out[upper + joint].q = (common * error * truth[upper + joint].q).normalized();
  }
  place_chain(body_, out, upper - 1, upper + 2);
  Vec3 unrest;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    unrest[static_cast<long>(axis)] =
        arm.slow[axis].step(dt, random_) + random_.normal(column_.jitter_white_m / std::sqrt(3.0));
  }
  // The unrest turns upper arm and forearm about shoulder and elbow; the bones keep their lengths.
  const Vec3 shoulder = out[upper].p, wrist = out[upper + 2].p, along = (wrist - shoulder).normalized();
  const Vec3 elbow = out[upper + 1].p - shoulder;
  Vec3 pole = elbow - elbow.dot(along) * along;
  const Quat hand = out[upper + 2].q;
  if (pole.norm() < 1e-3) pole = out[upper].q * Vec3(-1, 0, 0);
  solve_arm(body_, out, side, wrist + unrest, pole, hand);
}

Vec3 Suit::reported_ball(Side side, std::size_t frame, const Vec3& ball) const {
  (void)side;
  const Vec2 d = ball.head<2>() - true_pelvis_[frame];
  const Vec2 there = slip_.pelvis[frame] + Vec2((about_z(slip_.heading[frame]) * lift(d, 0)).head<2>());
  return lift(there, ball.z() - wearer_.body.ball_height + body_.ball_height + slip_.height[frame]);
}

void Suit::report_leg(Side side, std::size_t i, const Pose23& truth, Pose23& out) {
  const std::size_t f = side == Side::Right ? 0 : 1, foot = side == Side::Right ? kRightFoot : kLeftFoot;
  const auto& plants = gait_.plants[f];
  const FootState& state = gait_.feet[f][i];
  // A stance foot stays where the suit put it; a swinging one goes from there to where it will be put.
  const auto frame_of = [&](std::size_t k) {  // the middle of a stance; a long one is put right at its beginning
    const Plant& p = plants[k];
    const std::size_t last = std::min(p.lift, score_.frames() - 1);
    return k == 0 ? std::size_t{0}
                  : std::min(p.land + (last - p.land) / 2, p.land + static_cast<std::size_t>(0.3 * score_.rate_hz));
  };
  const Plant& from = plants[state.plant];
  double u = 0.0;
  std::size_t next = state.plant;
  if (!state.planted && state.plant + 1 < plants.size()) {
    next = state.plant + 1;
    u = smooth_step(static_cast<double>(i - from.lift) / static_cast<double>(plants[next].land - from.lift));
  }
  const std::size_t a = legs_ ? i : frame_of(state.plant), b = legs_ ? i : frame_of(next);
  Vec3 ball = reported_ball(side, a, state.ball) * (1.0 - u) + reported_ball(side, b, state.ball) * u;
  double slip = slip_.heading[a] * (1.0 - u) + slip_.heading[b] * u;
  if (legs_) {
    auto& [x, y, turn] = (*legs_)[f];
    const double dt = 1.0 / score_.rate_hz;
    ball.x() += x.step(dt, random_);
    ball.y() += y.step(dt, random_);
    slip += turn.step(dt, random_);
  }
  out[foot].q = (about_z(slip) * truth[foot].q).normalized();
  out[foot + 1].q = (about_z(slip) * truth[foot + 1].q).normalized();
  const Quat knee_turn = tilt_now_ * about_z(slip_.heading[i]);
  const Vec3 knee = knee_turn * (truth[foot - 1].p - 0.5 * (truth[foot].p + truth[foot - 2].p));
  Vec3 ankle = ball - out[foot].q * body_.offset[foot + 1];
  const double kneel = score_.kneel.at(static_cast<double>(i) / score_.rate_hz);
  if (kneel > 0.0) {  // knees on the floor: the feet follow the pelvis
    ankle += kneel * (out[kPelvis].p + knee_turn * (truth[foot].p - truth[kPelvis].p) - ankle);
  }
  const Quat keep = out[foot].q;
  solve_leg(body_, out, side, ankle, knee.norm() > 0.01 ? knee : Vec3(knee_turn * (truth[foot - 1].q * Vec3::UnitX())));
  out[foot].q = keep;
  place_chain(body_, out, foot + 1, foot + 1);
}

}  // namespace kinemap::sim
