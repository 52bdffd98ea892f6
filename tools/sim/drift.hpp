// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/sim/building.hpp"
#include "tools/sim/gait.hpp"
#include "tools/sim/options.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/score.hpp"

namespace kinemap::sim {

/// One column of the table of what goes wrong with an inertial suit. Standard deviations unless said otherwise.
struct DriftColumn {
  double walk_m_per_sqrt_m;     ///< translation random walk
  double step_scale;            ///< step length, per run
  double heading_bias_deg_min;  ///< constant per run
  double heading_walk_deg_sqrt_min;
  double magnetic_deg;  ///< how far a patch draws the heading; 0: no patches
  double magnetic_tau_low_s, magnetic_tau_high_s;
  double vertical_m_per_sqrt_m;
  double false_step_m, false_step_chance;     ///< per foot contact
  double tilt_limit_deg;                      ///< roll and pitch stay below
  double arm_deg;                             ///< each joint of the arm chain, correlated over seconds
  double body_scale;                          ///< of the entered dimensions
  double touch_spread_m, thickness_spread_m;  ///< of the touching point between wearers
  double jitter_white_m, jitter_slow_m;       ///< of the hand; the slow part is correlated over 1.5 s
  double packet_loss;                         ///< part of the datagrams
  double loss_burst;                          ///< mean number of samples lost in a row
};
DriftColumn column_of(Severity severity);

/// A piece of metal beside which the heading is drawn towards a wrong north.
struct MagneticPatch {
  Footprint metal;      ///< desk, rack or screen
  double radius = 0.4;  ///< from the metal, m
  double target = 0.0;  ///< where to, relative to the right heading, rad
  double tau_s = 20.0;  ///< first order, in and out
};
std::vector<MagneticPatch> draw_patches(const Building& building, const DriftColumn& column, Random& random);

/// First-order pull of one sensor's heading; back to 0 outside every patch.
class MagneticPull {
 public:
  double step(const Vec2& at, const std::vector<MagneticPatch>& patches, double dt_s);

 private:
  double value_ = 0.0, tau_s_ = 20.0;
};

/// How the suit's world slips against the true one: level position, height and heading, at every frame. Zero at the
/// first.
struct Slip {
  std::vector<Vec2> pelvis;      ///< reported level pelvis position
  std::vector<double> heading;   ///< error, rad, magnetic part included
  std::vector<double> magnetic;  ///< what metal near the pelvis adds to it, rad
  std::vector<double> height;    ///< error, m
};

/// `pelvis`: the true level way per frame.
Slip make_slip(const std::vector<Vec2>& pelvis, const Score& score, const Gait& gait, const DriftColumn& column,
               const std::vector<MagneticPatch>& patches, Random& random);

}  // namespace kinemap::sim
