// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/feet.hpp"

namespace kinemap {

/// Hears the feet that stand: dead reckoning from them beside the suit's own (zero-velocity updates). What they say of
/// an instant is known half a window (75 ms) later.
class SlipFold {
 public:
  explicit SlipFold(const TrackerConfig::Slip& config) : config_(config) {}

  /// Slip since begin(), up to half a window before this frame.
  std::optional<Slip> step(const SuitFrame& frame, const std::array<Sole, 2>& soles);
  /// From here on anew.
  void begin();
  /// The suit's world is another one, or nothing is known of the feet since.
  void reset();

 private:
  struct Foot {
    Eigen::Vector3d ankle, ball;  ///< odom frame, m
    double heading = 0.0;
    bool low = false;
  };
  struct Sample {
    double time_s = 0.0;
    Eigen::Vector2d p_pelvis;
    std::array<Foot, 2> feet;
  };
  /// Of one foot, as long as it stands.
  struct Standing {
    std::optional<double> since_s;
    std::optional<double> looked_s;                  ///< when it was last looked whether it moves …
    Eigen::Vector3d ball = Eigen::Vector3d::Zero();  ///< … and where it was
  };

  void hear(const Sample& before, const Sample& now);
  [[nodiscard]] bool stands(std::size_t foot, const Sample& middle) const;
  void look(std::size_t foot, const Sample& now);

  TrackerConfig::Slip config_;
  std::deque<Sample> window_;
  std::optional<Sample> heard_;  ///< up to this one
  std::array<Standing, 2> standing_;
  Slip slip_;
  double apart_rad_ = 0.0;      ///< the left foot's turn less the right one's, while both stood
  int moved_ = 0, stayed_ = 0;  ///< seconds that feet stood through, in this session
};

}  // namespace kinemap
