// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/activities.hpp"

#include <array>

namespace kinemap::sim {

namespace {

/// Both hands to a goal each from now on; returns the time when they are there.
double both_to(Composer& c, const ArmGoal& right, const ArmGoal& left, double seconds) {
  c.score().right.to(c.now(), c.now() + seconds * c.random().uniform(0.9, 1.1), right);
  c.score().left.to(c.now(), c.now() + seconds * c.random().uniform(0.9, 1.1), left);
  return c.now() + 1.1 * seconds;
}

void hands_down(Composer& c) {
  c.stand(both_to(c, c.hang(Side::Right), c.hang(Side::Left), c.random().uniform(0.5, 0.8)) - c.now());
}

void phone(Composer& c) {
  const Side side = c.random().chance(0.5) ? Side::Right : Side::Left;
  auto& arm = side == Side::Right ? c.score().right : c.score().left;
  arm.to(c.now(), c.now() + 0.8, postures::phone_at_ear(c.wearer(), side));
  c.stand(0.8 + c.random().uniform(1.5, 4.0));
  if (c.random().chance(0.5)) {  // paces while talking
    const Vec2 away = direction(c.random().uniform(-kPi, kPi)) * c.random().uniform(0.6, 1.4);
    const Vec2 goal = c.planner().pushed_clear(c.position() + away, c.position(), 0.45);
    c.walk_to(goal, std::nullopt);
    c.stand(c.random().uniform(0.5, 1.5));
  }
  arm.to(c.now(), c.now() + 0.7, c.hang(side));
  c.stand(0.8);
}

void hands_on_hips(Composer& c) {
  const auto& w = c.wearer();
  const HipStyle style = hip_of_gesture(w.habits, w.sloppiness, c.random());
  c.stand(both_to(c, postures::on_hip(w, Side::Right, style), postures::on_hip(w, Side::Left, style), 0.7) - c.now());
  c.stand(c.random().uniform(1.5, 4.0));
  hands_down(c);
}

void squat(Composer& c) {
  auto& s = c.score();
  const double h = c.wearer().body.stature, down = c.now() + c.random().uniform(0.9, 1.3);
  s.drop.to(c.now(), down, c.random().uniform(0.19, 0.25) * h);
  s.shift.to(c.now(), down, -0.10 * h);
  s.lean.to(c.now(), down, c.random().uniform(0.6, 0.85));
  c.stand(down - c.now() + c.random().uniform(1.0, 2.5));
  const double up = c.now() + c.random().uniform(0.9, 1.3);
  s.drop.to(c.now(), up, 0.0);
  s.shift.to(c.now(), up, 0.0);
  s.lean.to(c.now(), up, 0.0);
  c.stand(up - c.now() + 0.3);
}

void kneel(Composer& c) {
  auto& s = c.score();
  const Body& b = c.wearer().body;
  const double down = c.now() + c.random().uniform(1.3, 1.8);
  const double stand = b.ankle_height + 0.985 * (b.hip_height() - b.ankle_height);
  s.drop.to(c.now(), down, stand - (0.97 * b.thigh(Side::Right) + 0.05));
  s.kneel.to(c.now(), down, 1.0);
  c.stand(down - c.now() + c.random().uniform(2.0, 4.0));
  const double up = c.now() + c.random().uniform(1.3, 1.8);
  s.drop.to(c.now(), up, 0.0);
  s.kneel.to(c.now(), up, 0.0);
  c.stand(up - c.now() + 0.3);
}

void pick_up(Composer& c) {
  auto& s = c.score();
  const double h = c.wearer().body.stature, down = c.now() + c.random().uniform(1.0, 1.4);
  const Vec2 forward = direction(c.heading());
  const Vec3 thing = lift(c.position() + forward * 0.33 * h / 1.75 - left_of(forward) * 0.12, 0.10);
  s.lean.to(c.now(), down, c.random().uniform(1.25, 1.5));
  s.pelvis_pitch.to(c.now(), down, 0.35);
  s.drop.to(c.now(), down, 0.10 * h);
  s.shift.to(c.now(), down, -0.06 * h);
  s.right.to(c.now(), down, postures::reaching_down(c.wearer(), thing));
  c.stand(down - c.now() + c.random().uniform(0.3, 1.0));
  const double up = c.now() + c.random().uniform(1.0, 1.4);
  for (Track* track : {&s.lean, &s.pelvis_pitch, &s.drop, &s.shift}) track->to(c.now(), up, 0.0);
  s.right.to(c.now(), up, c.hang(Side::Right));
  c.stand(up - c.now() + 0.3);
}

void arms_up(Composer& c) {
  c.stand(both_to(c, postures::in_the_air(c.wearer(), Side::Right), postures::in_the_air(c.wearer(), Side::Left), 1.0) -
          c.now());
  c.stand(c.random().uniform(0.8, 2.0));
  hands_down(c);
}

void cross_arms(Composer& c) {
  c.stand(both_to(c, postures::crossed(c.wearer(), Side::Right), postures::crossed(c.wearer(), Side::Left), 0.8) -
          c.now());
  c.stand(c.random().uniform(2.0, 4.0));
  hands_down(c);
}

void scratch(Composer& c) {
  const Side side = c.random().chance(0.5) ? Side::Right : Side::Left;
  auto& arm = side == Side::Right ? c.score().right : c.score().left;
  ArmGoal goal = postures::scratching_head(c.wearer(), side);
  arm.to(c.now(), c.now() + 0.7, goal);
  for (int i = 1; i <= 6; ++i) {  // to and fro
    goal.wrist.z() += (i % 2 == 1 ? 0.03 : -0.03);
    arm.to(c.now() + 0.7 + 0.26 * (i - 1), c.now() + 0.7 + 0.26 * i, goal);
  }
  c.stand(0.7 + 0.26 * 6);
  arm.to(c.now(), c.now() + 0.7, c.hang(side));
  c.stand(0.8);
}

/// A left hand on the hip that means nothing: the right one touches nothing.
void idle_hip(Composer& c) {
  c.score().left.to(c.now(), c.now() + 0.6, c.hip_goal());
  c.stand(0.6 + c.random().uniform(0.4, 1.4));
  c.score().left.to(c.now(), c.now() + 0.6, c.hang(Side::Left));
  c.stand(0.7);
}

/// One hand flat on the nearest wall, weight on it. False when none is near.
bool lean_on_wall(Composer& c) {
  const WallFace* best = nullptr;
  Vec2 foot(0, 0);
  double least = 2.0;
  for (const auto& wall : c.building().walls) {
    const double u = (c.position() - wall.a).dot(wall.along()), off = (c.position() - wall.a).dot(wall.inward());
    const Vec2 p = wall.a + wall.along() * u;
    const bool door = wall.doorway && u > wall.doorway->first - 0.3 && u < wall.doorway->second + 0.3;
    if (u < 0.5 || u > wall.length() - 0.5 || off < 0.0 || off > least || door) continue;
    if (c.planner().clearance(p + wall.inward() * 0.5) < 0.4) continue;
    least = off, best = &wall, foot = p;
  }
  const Vec2 spot = best ? Vec2(foot + best->inward() * 0.60) : Vec2(0, 0);
  if (best == nullptr || !c.walk_to(spot, heading_of(-best->inward()))) return false;
  const Side side = c.random().chance(0.5) ? Side::Right : Side::Left;
  auto& arm = side == Side::Right ? c.score().right : c.score().left;
  const Vec2 hand = foot + left_of(-best->inward()) * 0.2 * lateral(side);
  arm.to(c.now(), c.now() + 0.7,
         postures::against(c.wearer(), lift(hand, 0.78 * c.wearer().body.stature), lift(best->inward(), 0)));
  c.score().lean.to(c.now(), c.now() + 0.9, 0.2);
  c.score().shift.to(c.now(), c.now() + 0.9, 0.08);
  c.stand(0.9 + c.random().uniform(1.5, 3.5));
  arm.to(c.now(), c.now() + 0.7, c.hang(side));
  c.score().lean.to(c.now(), c.now() + 0.7, 0.0);
  c.score().shift.to(c.now(), c.now() + 0.7, 0.0);
  c.stand(0.9);
  return true;
}

void sit_down(Composer& c, const Chair& chair, double shift, double drop, double tilt) {
  auto& s = c.score();
  const double t = c.now(), duration = c.random().uniform(1.2, 1.7);
  s.lean.to(t, t + 0.55 * duration, c.random().uniform(0.5, 0.7));  // nose over toes, …
  s.shift.to(t, t + duration, shift);
  s.drop.to(t + 0.1 * duration, t + duration, drop);
  s.pelvis_pitch.to(t, t + 0.5 * duration, 0.1);
  s.lean.to(t + 0.75 * duration, t + duration + 0.6, c.random().uniform(-0.12, 0.05));  // … then upright
  s.pelvis_pitch.to(t + 0.7 * duration, t + duration + 0.5, -tilt);
  if (c.random().chance(0.6))
    both_to(c, postures::on_thigh(c.wearer(), Side::Right), postures::on_thigh(c.wearer(), Side::Left), duration);
  (void)chair;
  c.stand(duration + 0.6);
}

void rise(Composer& c) {
  auto& s = c.score();
  const double t = c.now(), duration = c.random().uniform(1.2, 1.7);
  s.lean.to(t, t + 0.4 * duration, c.random().uniform(0.55, 0.75));
  s.pelvis_pitch.to(t, t + 0.4 * duration, 0.2);
  s.shift.to(t + 0.25 * duration, t + duration, 0.0);
  s.drop.to(t + 0.3 * duration, t + duration, 0.0);
  s.lean.to(t + 0.55 * duration, t + 1.15 * duration, 0.0);
  s.pelvis_pitch.to(t + 0.55 * duration, t + 1.1 * duration, 0.0);
  both_to(c, c.hang(Side::Right), c.hang(Side::Left), duration);
  c.stand(1.2 * duration);
}

}  // namespace

bool sit_on(Composer& c, const Chair& chair) {
  Random& random = c.random();
  const Body& b = c.wearer().body;
  const Vec2 forward = direction(chair.heading);
  // Hips 8–10 cm over the seat (hip joint to sitting bone), 5–10 cm before its centre; shanks about upright.
  const double hip = chair.height + random.uniform(0.08, 0.10), before = random.uniform(0.05, 0.10);
  const double knee = b.ankle_height + b.shank(Side::Right) * 0.985, dz = hip - knee;
  const double shift =
      -(std::sqrt(std::max(0.01, b.thigh(Side::Right) * b.thigh(Side::Right) - dz * dz)) - random.uniform(0.01, 0.06));
  const Vec2 spot = chair.seat + forward * (before - shift);
  if (!c.walk_to(spot, chair.heading + random.normal(0.04))) return false;
  const double stand = b.ankle_height + 0.985 * (b.hip_height() - b.ankle_height);
  const double begin = c.now();
  sit_down(c, chair, shift, stand - hip, random.uniform(0.28, 0.50));
  const double seated = c.now() - 0.6;
  c.stand(random.uniform(0.5, 1.5));
  if (random.chance(0.4)) {  // looks to one side
    c.score().twist.to(c.now(), c.now() + 0.8, random.uniform(0.3, 0.7) * random.sign());
    c.stand(0.8 + random.uniform(0.8, 2.0));
    c.score().twist.to(c.now(), c.now() + 0.8, 0.0);
  }
  c.stand(random.uniform(2.0, 4.0));
  const double up = c.now();
  rise(c);
  c.label({begin, c.now(), "sit", chair.id, seated, up});
  return true;
}

void distract(Composer& c) {
  using Act = void (*)(Composer&);
  struct Named {
    const char* name;
    Act act;
  };
  static constexpr std::array<Named, 9> kActs{{{"phone", phone},
                                               {"hands_on_hips", hands_on_hips},
                                               {"squat", squat},
                                               {"kneel", kneel},
                                               {"pick_up", pick_up},
                                               {"arms_up", arms_up},
                                               {"crossed_arms", cross_arms},
                                               {"scratch", scratch},
                                               {"hip_only", idle_hip}}};
  const double begin = c.now();
  const int pick = c.random().integer(0, static_cast<int>(kActs.size()));
  if (pick == static_cast<int>(kActs.size())) {
    if (lean_on_wall(c)) c.label({begin, c.now(), "distractor:lean", 0, -1, -1});
    return;
  }
  const Named& named = kActs[static_cast<std::size_t>(pick)];
  named.act(c);
  c.label({begin, c.now(), std::string("distractor:") + named.name, 0, -1, -1});
}

}  // namespace kinemap::sim
