// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "core/body.hpp"

namespace kinemap {

/// Left [0] and right [1].
inline constexpr std::array<Segment, 2> kFoot{Segment::LeftFoot, Segment::RightFoot};
inline constexpr std::array<Segment, 2> kToe{Segment::LeftToe, Segment::RightToe};

/// Points on the sole of one foot, odom frame, m. MVN gives the ankle and the ball of the foot; the sole lies
/// `ball_height_m` under the ball, and under the ankle by the same plus the drop from ankle to ball in the foot's own
/// frame, so it suits every foot size.
struct Sole {
  Eigen::Vector3d under_ankle;
  Eigen::Vector3d under_ball;
  double height_of_ankle_m = 0.0;  ///< ankle over the sole
  [[nodiscard]] double lowest_m() const { return std::min(under_ankle.z(), under_ball.z()); }
};

/// Soles of the left [0] and the right [1] foot.
std::array<Sole, 2> soles_of(const SuitFrame& frame, double ball_height_m);

/// The wearer's centre of mass in the odom frame, m: the streamed one if there is one, otherwise from the segments with
/// the mass fractions and centres of de Leva 1996 (table 4, men; the women's differ by less than 1 cm in the result).
Eigen::Vector3d center_of_mass_of(const SuitFrame& frame);

/// Level distance of `point` from the polygon round the feet that are on the floor (m, 0 inside), good to 1 %.
double outside_of_feet_m(const SuitFrame& frame, const std::array<Sole, 2>& soles, const Eigen::Vector3d& point);

}  // namespace kinemap
