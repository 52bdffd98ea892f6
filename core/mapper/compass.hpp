// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/mapper/config.hpp"

namespace kinemap {

/// How the suit's heading errs, as factors of the graph (reference: the drift table's rows of heading). A suit takes
/// its heading from gyroscopes that a compass holds to the north. So there is a lasting part, where its north is, which
/// turns slowly at a rate of its own (gyroscope bias) and wanders; and a passing one, since beside metal the compass
/// draws the heading to a wrong north and away from it the heading comes back, both over some 10 to 30 s. The first is
/// a scalar for each few seconds, the second a first-order Gauss-Markov process along the key poses, driven hard beside
/// metal. The graph's scalars are the rate and then the norths, in the order of time.
class Compass {
 public:
  explicit Compass(const MapperConfig::Odometry& config) : config_(config) {}

  /// The suit's world begins at pose `j`, or begins anew: nothing is known of its north but what the pose tells.
  void begin(const KeyPose& key_pose, std::size_t j, graph::Graph& graph);
  /// Pose `j` comes after pose `i` in the same world.
  void add(const KeyPose& from, const KeyPose& to, std::size_t i, std::size_t j, bool magnetic, graph::Graph& graph);

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(north_since_s_);
  }

 private:
  MapperConfig::Odometry config_;
  double north_since_s_ = 0.0;  ///< the newest north holds from then on
};

/// From one key pose to the next, s, and at least 10 ms: noise and weights divide by it.
double seconds_between(const KeyPose& from, const KeyPose& to);

/// Noise of the heading from one key pose to the next, standard deviation in rad. `magnetic`: beside metal.
double heading_sigma(const KeyPose& from, const KeyPose& to, bool magnetic, const MapperConfig::Odometry& config);

/// Turns the norths of the world that begins at pose `first`, and of later ones, by `angle` (rad): what was seen in it
/// is laid anew.
void turn_norths(graph::Graph& graph, std::size_t first, double angle);

/// Leaves out what the compass said of poses before `end`, and their norths. From there on it is as if the suit's world
/// had begun at the pose before, but for the rate that is known by now.
void leave_out_norths(graph::Graph& graph, std::size_t end);

}  // namespace kinemap
