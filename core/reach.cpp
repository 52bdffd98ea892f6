// SPDX-License-Identifier: Apache-2.0
#include "core/reach.hpp"

#include <algorithm>

namespace kinemap {
namespace {

constexpr double kStep = 0.1;        // m that a suit may correct itself by from one frame to the next
constexpr double kSprint = 8.0;      // m/s, for a second
constexpr double kRun = 3.0;         // m/s, for longer
constexpr double kTurn = 0.15;       // rad, as kStep
constexpr double kTurnSpeed = 15.0;  // rad/s: more than twice a turn a second

}  // namespace

bool within_reach(const Pose& a, const Pose& b, double seconds) {
  const double way = kStep + kSprint * std::min(seconds, 1.0) + kRun * std::max(0.0, seconds - 1.0);
  return (b.p - a.p).norm() <= way && a.q.angularDistance(b.q) <= kTurn + kTurnSpeed * seconds;
}

Pose stayed(const Pose& before, const Pose& after) {
  // Of all turns about the vertical, the one that brings `after` nearest to `before` undoes the twist between them.
  const Eigen::Quaterniond turned = after.q * before.q.conjugate();
  const double twist = 2.0 * std::atan2(turned.z(), turned.w());
  return {before.p, Eigen::AngleAxisd(-twist, Eigen::Vector3d::UnitZ()) * after.q};
}

}  // namespace kinemap
