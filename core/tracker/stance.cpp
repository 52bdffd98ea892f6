// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/stance.hpp"

#include <cmath>
#include <limits>

namespace kinemap {

std::optional<Eigen::Vector3d> StanceFold::step(const SuitFrame& frame, const std::array<Sole, 2>& soles) {
  std::array<bool, 2> rests{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Pose& foot = frame[kFoot[i]];
    const double speed = velocity_[i].step(frame.time_s, foot.p).norm();
    if (speed > config_.rest_speed_mps) moved_s_[i] = frame.time_s;
    const double upright = (foot.q * Eigen::Vector3d::UnitZ()).z();
    rests[i] = frame.time_s - moved_s_[i] > config_.rest_s && upright > std::cos(config_.flat_rad);
  }
  if (!rests[0] && !rests[1]) return std::nullopt;
  const std::size_t other = 1 - held_;
  const bool other_is_lower = soles[other].under_ankle.z() < soles[held_].under_ankle.z() - config_.level_m;
  if (!rests[held_] || (rests[other] && other_is_lower)) held_ = other;
  return frame[Segment::Pelvis].inverse() * soles[held_].under_ankle;
}

void StanceFold::reset() {
  for (auto& velocity : velocity_) velocity.reset();
  moved_s_.fill(-std::numeric_limits<double>::infinity());
}

}  // namespace kinemap
