// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/map.hpp"
#include "core/mapper/compass.hpp"
#include "core/mapper/config.hpp"

namespace kinemap {

/// Turns key poses into poses and factors of the graph: odometry (paper eq. 2), the compass, gravity, and the floor
/// under the stance foot.
class Odometry {
 public:
  explicit Odometry(const MapperConfig::Odometry& config) : config_(config), compass_(config) {}

  /// Appends a pose to the graph with its factors. Key poses come in order, without gaps.
  void add(const KeyPose& key_pose, graph::Graph& graph);

  /// A guess: the compass is not to be trusted between these times (s), the heading may have turned more than odometry
  /// says. Where the suit says how the field was (KeyPose::field_disturbed) that counts, and nothing is guessed.
  void suspect_heading(double begin_s, double end_s, graph::Graph& graph);

  /// Lets the first `count` key poses go, with the odometry between them and to the next one. Not all of them.
  void forget(std::size_t count) {
    key_poses_.erase(key_poses_.begin(), key_poses_.begin() + static_cast<std::ptrdiff_t>(count));
  }

  /// Those not let go, the newest last; to the k-th leads graph.between[k − 1].
  [[nodiscard]] const std::vector<KeyPose>& key_poses() const { return key_poses_; }
  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(compass_, key_poses_, suspect_until_s_, level_z_, last_stance_z_, levels_, off_level_, steady_, on_level_);
  }
  /// Height of the level that the wearer stands on, map frame, m.
  [[nodiscard]] double floor_z() const { return level_z_; }

 private:
  void add_between(const KeyPose& key_pose, graph::Graph& graph);
  void add_floor(const KeyPose& key_pose, graph::Graph& graph);

  MapperConfig::Odometry config_;
  Compass compass_;
  std::vector<KeyPose> key_poses_;
  double suspect_until_s_ = -1e9;  ///< key poses to come until then are beside metal, or just were
  double level_z_ = 0.0;
  std::optional<double> last_stance_z_;  ///< odom frame, m
  std::vector<double> levels_;           ///< heights of the levels found so far, map frame
  double off_level_ = 0.0;               ///< climbed since the last level, m
  int steady_ = 0;                       ///< stances in a row without a step up or down
  bool on_level_ = false;
};

/// The way between two key poses, in the first one's frame: as the suit says, less what it slipped as far as standing
/// feet tell; after a break, as a body can have moved.
Pose odometry_step(const KeyPose& from, const KeyPose& to, const MapperConfig::Odometry& config);

/// Square root information (upper) of the odometry between two key poses; tangent [δp; δθ] in the first one's frame. Of
/// the heading it has something to say at a break only and where feet stood; else that is the compass' matter.
graph::Matrix6 odometry_sqrt_information(const KeyPose& from, const KeyPose& to, const MapperConfig::Odometry& config);

/// The noise of a step of the odometry and the compass: as the graph has it, times `noise`.
StepSigma step_sigma(const graph::Graph& graph, const graph::BetweenFactor& between,
                     const graph::NoiseScales& noise = {});

}  // namespace kinemap
