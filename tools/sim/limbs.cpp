// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/limbs.hpp"

namespace kinemap::sim {

namespace {

/// Rotation whose columns are the given local axes in the world.
Quat from_axes(const Vec3& x, const Vec3& y, const Vec3& z) {
  Eigen::Matrix3d m;
  m.col(0) = x;
  m.col(1) = y;
  m.col(2) = z;
  return Quat(m).normalized();
}

struct Bend {
  Vec3 middle;  ///< elbow or knee
  Vec3 end;     ///< wrist or ankle, as far as it could be reached
  bool reached = true;
};

/// Two bones of lengths `a` and `b` from `root` to `target`, bent towards the direction `pole`.
Bend bend(const Vec3& root, const Vec3& target, const Vec3& pole, double a, double b) {
  Vec3 d = target - root;
  const double wanted = d.norm();
  const double distance = std::clamp(wanted, std::abs(a - b) + 0.02 * a, 0.9995 * (a + b));
  d = wanted > 1e-9 ? Vec3(d / wanted) : Vec3(-Vec3::UnitZ());
  Vec3 side = pole - pole.dot(d) * d;
  if (side.norm() < 1e-6) side = Vec3::UnitX() - Vec3::UnitX().dot(d) * d;
  side.normalize();
  const double along = (a * a - b * b + distance * distance) / (2.0 * distance);
  const double out = std::sqrt(std::max(0.0, a * a - along * along));
  return {root + d * along + side * out, root + d * distance, std::abs(distance - wanted) < 1e-6};
}

}  // namespace

bool solve_leg(const Body& body, Pose23& pose, Side side, const Vec3& ankle, const Vec3& knee_towards) {
  const std::size_t thigh = side == Side::Right ? kRightUpperLeg : kLeftUpperLeg, shank = thigh + 1, foot = thigh + 2;
  place_chain(body, pose, thigh, thigh);
  const Vec3 hip = pose[thigh].p;
  const Bend leg = bend(hip, ankle, knee_towards, body.thigh(side), body.shank(side));
  const Vec3 up = (hip - leg.middle).normalized(), up_shank = (leg.middle - leg.end).normalized();
  // The knee's axis (local y, to the left) is square to both bones: the knee bends backwards.
  Vec3 axis = up.cross(up_shank);
  if (axis.norm() < 1e-4) axis = up.cross(knee_towards);
  axis.normalize();
  if (axis.dot(up.cross(knee_towards)) < 0.0) axis = -axis;
  pose[thigh].q = from_axes(axis.cross(up), axis, up);
  pose[shank].q = from_axes(axis.cross(up_shank), axis, up_shank);
  place_chain(body, pose, shank, foot);
  return leg.reached;
}

bool solve_arm(const Body& body, Pose23& pose, Side side, const Vec3& wrist, const Vec3& elbow_towards,
               const Quat& hand) {
  const std::size_t girdle = side == Side::Right ? kRightShoulder : kLeftShoulder;
  const std::size_t upper = girdle + 1, fore = girdle + 2, last = girdle + 3;
  place_chain(body, pose, girdle, upper);
  const Bend arm = bend(pose[upper].p, wrist, elbow_towards, body.upper_arm(side), body.forearm(side));
  // In the T-pose the arm runs along ±y and the elbow bends forward, about the local z axis.
  const double s = lateral(side);
  const Vec3 u = (arm.middle - pose[upper].p).normalized(), f = (arm.end - arm.middle).normalized();
  Vec3 hinge = -s * u.cross(f);
  if (hinge.norm() < 1e-4) hinge = s * u.cross(elbow_towards);
  hinge.normalize();
  const Vec3 yu = s * u, yf = s * f;
  pose[upper].q = from_axes(yu.cross(hinge), yu, hinge);
  const Quat straight = from_axes(yf.cross(hinge), yf, hinge);
  // Turning the hand over turns the forearm by a part of it.
  const Vec3 z_hand = straight.conjugate() * (hand * Vec3::UnitZ());
  pose[fore].q = straight * about_y(0.8 * z_hand.x());
  pose[last].q = hand;
  place_chain(body, pose, fore, last);
  return arm.reached;
}

Quat hand_orientation(Side side, const Vec3& fingers, const Vec3& palm) {
  const Vec3 y = lateral(side) * fingers.normalized();
  Vec3 z = -palm + palm.dot(y) * y;
  if (z.norm() < 1e-6) z = y.unitOrthogonal();
  z.normalize();
  return from_axes(y.cross(z), y, z);
}

}  // namespace kinemap::sim
