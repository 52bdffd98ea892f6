// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/feet.hpp"
#include "core/tracker/smoothed_velocity.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

/// Bouts of sitting: the legs sit, the pelvis is still, and for a good part of the bout the centre of mass is where the
/// feet cannot carry it. So a squat, a stoop and a jump's crouch are none, a kneel is none by its shanks, and neither
/// is a perch (thighs at 30–50°, hips over 0.65 m): what carries a perching wearer is most often a table's edge. For
/// each frame: step(), then record(). Memory is bounded by max_samples.
class SittingFold {
 public:
  explicit SittingFold(const TrackerConfig::Sitting& config) : config_(config), velocity_(config.smoothing_s) {}

  /// Opens, keeps or ends the bout; returns one that has just ended and was a seat.
  std::optional<Sitting> step(const SuitFrame& frame, const std::array<Sole, 2>& soles);
  /// Adds this frame's seat if the wearer sits still. `latest` is the latest key pose, at or before the frame.
  void record(const SuitFrame& frame, const KeyPose& latest);
  /// Ends an open bout (end of the stream).
  std::optional<Sitting> close();
  /// Ends an open bout and forgets the motion (discontinuity).
  std::optional<Sitting> reset();
  /// What was added to an open bout since the last call, if anything was.
  std::optional<UnfinishedSitting> take_unfinished();
  /// Before the first frame: goes on with the bout of another fold, if one was open.
  void resume(const Interrupted& before);

  [[nodiscard]] bool legs_sit() const { return legs_sit_; }
  [[nodiscard]] bool open() const { return open_; }
  /// This frame is the first sample of a bout: it wants a key pose of its own.
  [[nodiscard]] bool starting() const { return open_ && still_ && samples_.empty(); }

 private:
  struct Sample : SeatSample {
    Pose T_odom_key;
    [[nodiscard]] Pose T_odom_seat() const { return T_odom_key * T_key_seat; }
  };

  std::optional<Sitting> end_if_over(double time_s, const Eigen::Vector3d& p_pelvis);
  void open(double time_s);
  void judge(const SuitFrame& frame, const std::array<Sole, 2>& soles, bool was_still);
  void keep(const Sample& sample);
  [[nodiscard]] bool is_seat() const;
  [[nodiscard]] Sitting summary() const;

  TrackerConfig::Sitting config_;
  SmoothedVelocity velocity_;
  bool legs_sit_ = false;
  bool still_ = false;
  bool outside_ = false;
  double hips_m_ = 0.0;  ///< hips over the floor at this frame
  double time_s_ = 0.0;  ///< of the newest frame

  bool open_ = false;
  double begin_s_ = 0.0;
  double seen_s_ = 0.0;         ///< last frame in which the legs sat
  double still_s_ = 0.0;        ///< time sat still
  double unsupported_s_ = 0.0;  ///< of which with the centre of mass outside of the feet
  double spacing_s_ = 0.0;
  double told_s_ = 0.0;      ///< take_unfinished() has given away what was before
  bool told_still_ = false;  ///< … and said so
  std::vector<Sample> samples_;
};

}  // namespace kinemap
