// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/stance.hpp"

#include <cmath>

namespace kinemap {

std::optional<Eigen::Vector3d> StanceFold::step(const SuitFrame& frame, const std::array<Sole, 2>& soles) {
  constexpr std::array<Segment, 2> kFoot{Segment::LeftFoot, Segment::RightFoot};
  const double lowest = std::min(soles[0].lowest_m(), soles[1].lowest_m());
  std::array<bool, 2> carries{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Pose& foot = frame[kFoot[i]];
    const double speed = velocity_[i].step(frame.time_s, foot.p).norm();
    const double upright = (foot.q * Eigen::Vector3d::UnitZ()).z();
    carries[i] = speed < config_.rest_speed_mps && upright > std::cos(config_.flat_rad) &&
                 soles[i].lowest_m() < lowest + config_.above_lower_m;
  }
  if (!carries[held_]) held_ = 1 - held_;
  if (!carries[held_]) return std::nullopt;
  return frame[Segment::Pelvis].inverse() * soles[held_].under_ankle;
}

void StanceFold::reset() {
  for (auto& velocity : velocity_) velocity.reset();
}

}  // namespace kinemap
