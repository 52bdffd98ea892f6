// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "core/tracker/config.hpp"

namespace kinemap {

/// Judges whether metal bends the magnetic field at the pelvis, and so draws the heading away. Strength and dip depend
/// on the place on earth and on where the suit was calibrated; what they usually are is learnt as the wearer walks, a
/// value for each place and not for each second: people stand at metal desks for long and walk far from them.
class MagneticFold {
 public:
  explicit MagneticFold(const TrackerConfig::Magnetic& config) : config_(config) {}

  /// Whether the field is disturbed now; nullopt when the suit does not say, or while the usual field is not known yet.
  std::optional<bool> step(const SuitFrame& frame);
  void reset() { *this = MagneticFold(config_); }

 private:
  void smooth(double time_s, const MagneticField& field);
  void learn(const Eigen::Vector2d& place);

  TrackerConfig::Magnetic config_;
  bool started_ = false;
  double seen_s_ = 0.0;                              ///< last frame that told the field
  MagneticField field_;                              ///< smoothed
  MagneticField usual_;                              ///< medians over places_
  bool disturbed_ = false;                           ///< against usual_
  std::vector<MagneticField> places_;                ///< the field at the latest places, as a ring
  std::size_t oldest_ = 0;                           ///< in places_, once it is full
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();  ///< the latest of them, odom frame
};

}  // namespace kinemap
