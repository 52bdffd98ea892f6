// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/trackers.hpp"

namespace kinemap::sim {

namespace {

constexpr std::array<Bone, 17> kCarriers{
    kPelvis,        kT8,           kHead,         kRightShoulder, kRightUpperArm, kRightForearm,
    kRightHand,     kLeftShoulder, kLeftUpperArm, kLeftForearm,   kLeftHand,      kRightUpperLeg,
    kRightLowerLeg, kRightFoot,    kLeftUpperLeg, kLeftLowerLeg,  kLeftFoot};
constexpr double kFieldNoise = 0.004, kGyroNoise = 0.01, kAccelerationNoise = 0.05;

std::array<float, 3> floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vec3 noise(double sigma, Random& random) {
  const double x = random.normal(sigma), y = random.normal(sigma), z = random.normal(sigma);
  return {x, y, z};
}

}  // namespace

Trackers::Trackers(const Session& session)
    : session_(session), random_(session.options().seed, 9), world_(session.patches(), random_) {
  for (auto& mount : mount_) mount = rotation(noise(1.0, random_));
}

std::vector<mxtp::TrackerItem> Trackers::measure(const Sample& sample) {
  std::vector<mxtp::TrackerItem> items;
  const Quat to_building = session_.T_map_building().q.conjugate();
  for (std::size_t i = 0; i < kCount; ++i) {
    const Placed& truth = sample.truth[kCarriers[i]];
    const Quat q = (truth.q * mount_[i]).normalized(),
               believed = (sample.reported[kCarriers[i]].q * mount_[i]).normalized();
    const Vec3 field = (to_building * q).conjugate() * world_.at(session_.to_building(truth.p));
    Quat turn = any_ ? last_[i].conjugate() * q : Quat::Identity();
    if (turn.w() < 0.0) turn.coeffs() *= -1.0;
    last_[i] = q;
    // Of the accelerations only gravity: nobody here uses more.
    const Vec3 gravity = q.conjugate() * Vec3(0, 0, 9.81), jolt = noise(kAccelerationNoise, random_);
    items.push_back({kCarriers[i] + 1,
                     {static_cast<float>(believed.w()), static_cast<float>(believed.x()),
                      static_cast<float>(believed.y()), static_cast<float>(believed.z())},
                     floats(believed * jolt),
                     floats(gravity + jolt),
                     floats(2.0 * turn.vec() * session_.options().rate_hz + noise(kGyroNoise, random_)),
                     floats(field + noise(kFieldNoise, random_))});
  }
  any_ = true;
  return items;
}

}  // namespace kinemap::sim
