// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/graph.hpp"
#include "core/graph/marginals.hpp"
#include "core/map.hpp"
#include "core/mapper/config.hpp"

namespace kinemap {

/// How well the newest key pose is known: the graph's marginal where one was computed, carried on by the noise of the
/// odometry since. Height and tilt are observed at every key pose (floor, gravity) and do not grow.
class PoseCovariance {
 public:
  explicit PoseCovariance(const MapperConfig::Odometry& config) : config_(config) {}

  /// The marginal of the newest key pose, in the tangent of core/graph/graph.hpp.
  void set(const Pose& T_map_pelvis, const graph::Matrix6& marginal);
  /// A key pose more, `T_i_j` from the one before, whose pose is `T_map_i`, with the noise of that step.
  void add(const Pose& T_map_i, const Pose& T_i_j, const StepSigma& step);

  /// As MapSnapshot::pelvis_covariance has it, with the scale of the way, which the graph does not know; `p_first` is
  /// where the way began, `way` as in NoiseScales.
  [[nodiscard]] graph::Matrix6 published(const Pose& T_map_pelvis, const Eigen::Vector3d& p_first, double way) const;

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(covariance_);
  }

 private:
  MapperConfig::Odometry config_;
  graph::Matrix6 covariance_ = graph::Matrix6::Zero();  // position and rotation vector, both in the map's axes
};

/// The joint covariance of the newest pose alone, in its tangent.
graph::Matrix6 newest_marginal(const graph::Graph& graph, const graph::Marginals& marginals);

}  // namespace kinemap
