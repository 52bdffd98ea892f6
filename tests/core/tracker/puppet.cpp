// SPDX-License-Identifier: Apache-2.0
#include "tests/core/tracker/puppet.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace kinemap::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t index(Segment s) { return static_cast<std::size_t>(s); }

// Parent of each segment and its origin in the parent's frame in the T-pose: proportions of a real wearer, for a
// stature of 1.75 m.
struct Bone {
  Segment parent;
  double x, y, z;
};
constexpr std::array<Bone, kSegmentCount> kBones{{
    {Segment::Pelvis, 0, 0, 0},
    {Segment::Pelvis, -0.011, 0, 0.100},
    {Segment::L5, 0, 0, 0.111},
    {Segment::L3, 0, 0, 0.101},
    {Segment::T12, 0, 0, 0.101},
    {Segment::T8, 0, 0, 0.142},
    {Segment::Neck, 0, 0, 0.094},
    {Segment::T8, 0, -0.031, 0.079},
    {Segment::RightShoulder, 0, -0.143, 0},
    {Segment::RightUpperArm, 0, -0.305, 0},
    {Segment::RightForearm, 0, -0.250, 0},
    {Segment::T8, 0, 0.031, 0.079},
    {Segment::LeftShoulder, 0, 0.143, 0},
    {Segment::LeftUpperArm, 0, 0.305, 0},
    {Segment::LeftForearm, 0, 0.250, 0},
    {Segment::Pelvis, 0, -0.082, 0},
    {Segment::RightUpperLeg, 0, 0, -0.421},
    {Segment::RightLowerLeg, 0, 0, -0.412},
    {Segment::RightFoot, 0.178, 0, -0.078},
    {Segment::Pelvis, 0, 0.082, 0},
    {Segment::LeftUpperLeg, 0, 0, -0.421},
    {Segment::LeftLowerLeg, 0, 0, -0.412},
    {Segment::LeftFoot, 0.178, 0, -0.078},
}};
constexpr double kSoleUnderBall = 0.018;

struct Chain {
  Segment root, middle, end;
};
constexpr std::array<Chain, 2> kArms{{{Segment::LeftUpperArm, Segment::LeftForearm, Segment::LeftHand},
                                      {Segment::RightUpperArm, Segment::RightForearm, Segment::RightHand}}};
constexpr std::array<Chain, 2> kLegs{{{Segment::LeftUpperLeg, Segment::LeftLowerLeg, Segment::LeftFoot},
                                      {Segment::RightUpperLeg, Segment::RightLowerLeg, Segment::RightFoot}}};
constexpr std::array<Segment, 2> kToes{Segment::LeftToe, Segment::RightToe};
constexpr std::array<Segment, 2> kShoulders{Segment::LeftShoulder, Segment::RightShoulder};

bool is_arm(std::size_t i) { return (i >= 8 && i <= 10) || (i >= 12 && i <= 14); }

// The middle joint of a two-bone chain from `root` towards `end`, bent towards `hint`.
Vector3d middle_joint(const Vector3d& root, const Vector3d& end, double upper, double lower, const Vector3d& hint) {
  const Vector3d u = (end - root).normalized();
  const double d = std::clamp((end - root).norm(), std::abs(upper - lower) + 1e-3, upper + lower - 1e-3);
  const double cos_root = (upper * upper + d * d - lower * lower) / (2.0 * upper * d);
  const Vector3d n = (hint - hint.dot(u) * u).normalized();
  return root + upper * (cos_root * u + std::sqrt(std::max(0.0, 1.0 - cos_root * cos_root)) * n);
}

// `base` turned the shortest way so that its `axis` points along `direction`.
Quaterniond aimed(const Quaterniond& base, const Vector3d& axis, const Vector3d& direction) {
  return Quaterniond::FromTwoVectors(base * axis, direction) * base;
}

Quaterniond pitched(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitY())); }

double lowest_sole(const SuitFrame& frame) {
  double lowest = 1e9;
  for (std::size_t side = 0; side < 2; ++side) {
    const Pose& foot = frame[kLegs[side].end];
    const Pose& toe = frame[kToes[side]];
    const double drop = -(foot.inverse() * toe.p).z() + kSoleUnderBall;
    lowest = std::min({lowest, (foot * Vector3d(0, 0, -drop)).z(), (toe * Vector3d(0, 0, -kSoleUnderBall)).z()});
  }
  return lowest;
}

}  // namespace

Puppet::Puppet(double stature_m, const SuitErrors& errors) : scale_(stature_m / 1.75) {
  std::mt19937 random(errors.seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    true_[i] = scale_ * Vector3d(kBones[i].x, kBones[i].y, kBones[i].z);
    suit_[i] = true_[i] * (1.0 + (i >= index(Segment::RightUpperLeg) ? errors.body : -errors.body));
    const Vector3d axis = Vector3d(normal(random), normal(random), is_arm(i) ? normal(random) : 0.0).normalized();
    error_[i] = Quaterniond(AngleAxisd(is_arm(i) ? errors.arm_rad : errors.tilt_rad, axis));
  }
}

double Puppet::ankle_m() const { return scale_ * (0.078 + kSoleUnderBall); }

SuitFrame Puppet::chain(const Bones& bones, const Offsets& offsets) const {
  SuitFrame frame;
  frame[Segment::Pelvis] = {bones.pelvis, bones.q[0]};
  for (std::size_t i = 1; i < kSegmentCount; ++i) {
    const Pose& parent = frame[kBones[i].parent];
    frame.segments[i] = {parent * offsets[i], bones.q[i]};
  }
  return frame;
}

Bones Puppet::pose(const Figure& figure) const {
  const Quaterniond q_level(AngleAxisd(figure.heading, Vector3d::UnitZ()));
  Bones bones;
  bones.pelvis = figure.hips;
  if (!figure.hips_exact) bones.pelvis.z() *= scale_;
  const Quaterniond q_pelvis =
      q_level * pitched(figure.pelvis_pitch) * Quaterniond(AngleAxisd(figure.pelvis_roll, Vector3d::UnitX()));
  bones.q.fill(q_pelvis);
  const Quaterniond q_chest = q_level * pitched(figure.trunk_pitch) * AngleAxisd(figure.chest_twist, Vector3d::UnitZ());
  constexpr std::array kSpine{Segment::L5, Segment::L3, Segment::T12, Segment::T8};
  for (std::size_t i = 0; i < kSpine.size(); ++i) {
    bones.q[index(kSpine[i])] = q_pelvis.slerp(0.25 * static_cast<double>(i + 1), q_chest);
  }
  for (const Segment s : {Segment::Neck, Segment::Head, Segment::LeftShoulder, Segment::RightShoulder}) {
    bones.q[index(s)] = q_chest;
  }
  const SuitFrame trunk = chain(bones, true_);
  for (std::size_t side = 0; side < 2; ++side) {
    const double outward = side == 0 ? 1.0 : -1.0;
    const auto sided = [&](const Vector3d& v) { return Vector3d(v.x(), outward * v.y(), v.z()); };

    const Chain& leg = kLegs[side];
    const Vector3d& hip = trunk[leg.root].p;
    const Vector3d floor(bones.pelvis.x(), bones.pelvis.y(), 0.0);
    const Vector3d ankle = floor + q_level * (scale_ * sided(figure.ankle[side])) + Vector3d(0, 0, ankle_m());
    const Vector3d knee = middle_joint(hip, ankle, true_[index(leg.middle)].norm(), true_[index(leg.end)].norm(),
                                       q_level * sided(figure.knee[side]));
    bones.q[index(leg.root)] = aimed(q_pelvis, -Vector3d::UnitZ(), knee - hip);
    bones.q[index(leg.middle)] = aimed(bones.q[index(leg.root)], -Vector3d::UnitZ(), ankle - knee);
    bones.q[index(leg.end)] = q_level * pitched(figure.foot_pitch[side]);
    bones.q[index(kToes[side])] = q_level * pitched(std::min(figure.foot_pitch[side], 0.0));

    const Chain& arm = kArms[side];
    const ArmSpec& spec = figure.arm[side];
    const Vector3d& shoulder = trunk[arm.root].p;
    const Vector3d origin = spec.origin == ArmSpec::Origin::Shoulder ? shoulder : hip;
    const Quaterniond axes = spec.origin == ArmSpec::Origin::Hip ? q_pelvis : q_level;
    const Vector3d wrist = origin + axes * (scale_ * sided(spec.wrist));
    const Vector3d elbow = middle_joint(shoulder, wrist, true_[index(arm.middle)].norm(), true_[index(arm.end)].norm(),
                                        axes * sided(spec.elbow));
    const Vector3d along(0, outward, 0);
    bones.q[index(arm.root)] = aimed(bones.q[index(kShoulders[side])], along, elbow - shoulder);
    bones.q[index(arm.middle)] = aimed(bones.q[index(arm.root)], along, wrist - elbow);
    bones.q[index(arm.end)] = aimed(bones.q[index(arm.middle)], along, axes * sided(spec.hand));
  }
  return bones;
}

SuitFrame Puppet::truth(const Bones& bones, double time_s) const {
  SuitFrame frame = chain(bones, true_);
  frame.time_s = time_s;
  return frame;
}

SuitFrame Puppet::report(const Bones& bones, double time_s) const {
  Bones measured = bones;
  for (std::size_t i = 0; i < kSegmentCount; ++i) measured.q[i] = bones.q[i] * error_[i];
  SuitFrame frame = chain(measured, suit_);
  // The suit knows the floor from the foot contacts.
  const double lift = lowest_sole(chain(bones, true_)) - lowest_sole(frame);
  for (Pose& segment : frame.segments) segment.p.z() += lift;
  frame.time_s = time_s;
  return frame;
}

Figure Puppet::balanced(Figure figure, double forward_m) const {
  const auto forward_of_mass = [&](double trunk_pitch) {
    figure.trunk_pitch = trunk_pitch;
    const SuitFrame f = truth(pose(figure), 0.0);
    const auto middle = [&](Segment a, Segment b) -> Vector3d { return 0.5 * (f[a].p + f[b].p); };
    const Vector3d trunk = f[Segment::Pelvis].p + 0.5 * (f[Segment::Neck].p - f[Segment::Pelvis].p);
    const Vector3d arms = 0.5 * (f[Segment::LeftForearm].p + f[Segment::RightForearm].p);
    const Vector3d thighs = 0.5 * (middle(Segment::LeftUpperLeg, Segment::LeftLowerLeg) +
                                   middle(Segment::RightUpperLeg, Segment::RightLowerLeg));
    const Vector3d shanks =
        0.5 * (middle(Segment::LeftLowerLeg, Segment::LeftFoot) + middle(Segment::RightLowerLeg, Segment::RightFoot));
    const Vector3d mass = 0.44 * trunk + 0.07 * f[Segment::Head].p + 0.10 * arms + 0.28 * thighs + 0.11 * shanks;
    const Vector3d forward(std::cos(figure.heading), std::sin(figure.heading), 0);
    return forward.dot(mass - figure.hips);
  };
  double low = -0.3;
  double high = 1.5;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (low + high);
    (forward_of_mass(middle) < forward_m ? low : high) = middle;
  }
  figure.trunk_pitch = 0.5 * (low + high);
  return figure;
}

Bones blend(const Bones& a, const Bones& b, double share) {
  Bones out;
  out.pelvis = a.pelvis + share * (b.pelvis - a.pelvis);
  for (std::size_t i = 0; i < kSegmentCount; ++i) out.q[i] = a.q[i].slerp(share, b.q[i]);
  return out;
}

std::vector<SuitFrame> perform(const Puppet& puppet, const std::vector<Act>& acts, const Sampling& sampling) {
  std::mt19937 random(sampling.seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<SuitFrame> frames;
  std::uint64_t sample = 0;
  double begin_s = 0.0;
  for (std::size_t k = 0; k < acts.size(); ++k) {
    for (;; ++sample) {
      const double t = static_cast<double>(sample) / sampling.rate_hz - begin_s;
      if (t >= acts[k].duration_s) break;
      const bool lost = sample > 0 && uniform(random) < sampling.loss;
      if (lost) continue;
      Bones bones = puppet.pose(acts[k].figure(t));
      if (k > 0 && t < sampling.blend_s) {
        const double x = t / sampling.blend_s;
        bones = blend(puppet.pose(acts[k - 1].figure(acts[k - 1].duration_s + t)), bones, x * x * (3.0 - 2.0 * x));
      }
      frames.push_back(puppet.report(bones, static_cast<double>(sample) / sampling.rate_hz));
      frames.back().index = sample;
    }
    begin_s += acts[k].duration_s;
  }
  return frames;
}

}  // namespace kinemap::test
