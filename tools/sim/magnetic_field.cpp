// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/magnetic_field.hpp"

namespace kinemap::sim {

MagneticWorld::MagneticWorld(const std::vector<MagneticPatch>& patches, Random& random) : patches_(patches) {
  const double dip = radians(random.uniform(58.0, 70.0)), north = random.uniform(-kPi, kPi);  // Europe
  earth_ = lift(direction(north) * std::cos(dip), -std::sin(dip));
  for (auto& wave : waves_) {
    const double length = random.uniform(2.0, 6.0);
    wave.number = lift(direction(random.uniform(-kPi, kPi)), 0) * (2 * kPi / length);
    wave.amplitude = Vec3(random.normal(0.02), random.normal(0.02), random.normal(0.02));
    wave.phase = random.uniform(0.0, 2 * kPi);
  }
  for (const auto& patch : patches_) {
    // North is turned by what the heading is drawn to; strength and dip change as well, each patch in its own way.
    const Vec3 turned = about_z(patch.target) * earth_ - earth_;
    const Vec3 own(random.normal(0.12), random.normal(0.12), random.normal(0.15));
    bent_.push_back(turned + own);
  }
}

Vec3 MagneticWorld::at(const Vec3& p) const {
  Vec3 field = earth_;
  for (const auto& wave : waves_) field += wave.amplitude * std::sin(wave.number.dot(p) + wave.phase);
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    // All of it near the metal, none of it half as far again as where it begins to act on the heading.
    const double u = patches_[i].metal.distance(p.head<2>()) / patches_[i].radius;
    field += bent_[i] * (1.0 - smooth_step((u - 0.4) / 1.1));
  }
  return field;
}

}  // namespace kinemap::sim
