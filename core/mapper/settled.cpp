// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/settled.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kMostFree = 4500;  // key poses
constexpr std::size_t kKeptFree = 3000;
constexpr std::size_t kProbe = 50;  // every so many key poses the way is looked at
constexpr double kKnown = 0.3;      // m: standard deviation of a place that is well known

}  // namespace

std::size_t first_unsettled_pose(const graph::Graph& graph, const graph::Marginals& marginals) {
  const std::size_t free = graph.poses.size() - graph.first_free_pose;
  if (free < kMostFree) return graph.first_free_pose;
  const std::size_t end = graph.poses.size() - kKeptFree;
  std::size_t settled = graph.first_free_pose;
  for (std::size_t i = settled; i < end; i += kProbe) {
    const graph::Variable pose{graph::Variable::Kind::Pose, i};
    if (marginals.joint({&pose, 1}).topLeftCorner<2, 2>().trace() > 2.0 * kKnown * kKnown) break;
    settled = i;
  }
  return settled;
}

}  // namespace kinemap
