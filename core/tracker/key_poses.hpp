// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/config.hpp"
#include "core/tracker/unfinished.hpp"

namespace kinemap {

/// Chooses the frames whose pelvis pose becomes a node of the graph, and sums path and turn between them.
class KeyPoseFold {
 public:
  /// Why a key pose may be due sooner than the motion asks for.
  struct Demand {
    bool busy = false;  ///< tracing or sitting: the shorter time limit holds
    bool now = false;   ///< something begins at this frame and needs a key pose to refer to
  };

  explicit KeyPoseFold(const TrackerConfig::KeyPoses& config) : config_(config) {}

  /// Before the first frame: goes on from the last key pose of another fold (Tracker::resume).
  void resume(const Interrupted& before, double unseen_path_m);

  /// `p_pelvis_stance` as in KeyPose, `field_disturbed` at this frame, `slip` since the latest key pose. The first
  /// frame and a discontinuity always give a key pose.
  std::optional<KeyPose> step(const SuitFrame& frame, Demand demand,
                              const std::optional<Eigen::Vector3d>& p_pelvis_stance,
                              std::optional<bool> field_disturbed, const std::optional<Slip>& slip);
  /// The newest frame as a key pose, unless it is one already.
  std::optional<KeyPose> finish();

  [[nodiscard]] SinceKeyPose since_latest() const;
  [[nodiscard]] const KeyPose& latest() const { return latest_; }
  /// T_odom_pelvis of the newest frame.
  [[nodiscard]] const Pose& newest() const { return next_.T_odom_pelvis; }
  [[nodiscard]] double total_path_m() const { return total_path_m_; }

 private:
  [[nodiscard]] bool due(const SuitFrame& frame, Demand demand) const;
  void advance(const Pose& T_odom_pelvis, double path_step_m, double turn_step_rad);
  void restart(const Pose& T_odom_pelvis);
  KeyPose emit();

  TrackerConfig::KeyPoses config_;
  bool started_ = false;
  KeyPose latest_;
  KeyPose next_;                                          ///< the newest frame, should it become a key pose
  Eigen::Vector3d path_point_ = Eigen::Vector3d::Zero();  ///< where path_m has been summed to
  double turn_heading_ = 0.0;                             ///< to which heading turn_rad has been summed
  double latest_heading_ = 0.0;                           ///< of the latest key pose
  double heading_ = 0.0;                                  ///< of the newest frame
  double total_path_m_ = 0.0;
};

}  // namespace kinemap
