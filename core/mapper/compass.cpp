// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/compass.hpp"

#include <algorithm>
#include <cmath>

#include "core/graph/factors.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kRate = 0;  // index of the rate among the scalars
constexpr std::size_t kFirstNorth = 1;
constexpr double kSameNorth = 10.0;  // s: so long a north is taken for one number
constexpr double kShortest = 0.01;   // s

}  // namespace

double seconds_between(const KeyPose& from, const KeyPose& to) { return std::max(kShortest, to.time_s - from.time_s); }

double heading_sigma(const KeyPose& from, const KeyPose& to, bool magnetic, const MapperConfig::Odometry& config) {
  const double rate = magnetic ? config.magnetic_rad_per_sqrt_s : config.heading_rad_per_sqrt_s;
  return std::hypot(rate * std::sqrt(seconds_between(from, to)), config.heading_rad_per_rad * to.turn_rad);
}

void Compass::begin(const KeyPose& key_pose, std::size_t j, graph::Graph& graph) {
  if (graph.scalars.empty()) {
    graph.scalars.push_back(0.0);
    graph.scalar_priors.push_back({kRate, 0.0, config_.north_rate_rad_per_s});
  }
  const Eigen::Quaterniond& q = key_pose.T_odom_pelvis.q;
  graph.scalars.push_back(graph::heading_offset(graph.poses[j].q, q));
  graph.compasses.push_back({j, j, graph.scalars.size() - 1, q, q, 0.0, config_.north_sigma_rad});
  north_since_s_ = key_pose.time_s;
}

void Compass::add(const KeyPose& from, const KeyPose& to, std::size_t i, std::size_t j, bool magnetic,
                  graph::Graph& graph) {
  if (const double age = to.time_s - north_since_s_; age >= kSameNorth) {
    const std::size_t before = graph.scalars.size() - 1;
    graph.scalars.push_back(graph.scalars[before] + graph.scalars[kRate] * age);
    graph.drifts.push_back({before, before + 1, kRate, age, config_.north_rad_per_sqrt_s * std::sqrt(age)});
    north_since_s_ = to.time_s;
  }
  graph.compasses.push_back({i, j, graph.scalars.size() - 1, from.T_odom_pelvis.q, to.T_odom_pelvis.q,
                             std::exp(-seconds_between(from, to) / config_.heading_return_s),
                             heading_sigma(from, to, magnetic, config_)});
}

void turn_norths(graph::Graph& graph, std::size_t first, double angle) {
  const auto begin = std::find_if(graph.compasses.begin(), graph.compasses.end(),
                                  [&](const graph::CompassFactor& f) { return f.i == f.j && f.j == first; });
  if (begin == graph.compasses.end()) return;
  for (std::size_t k = begin->north; k < graph.scalars.size(); ++k) graph.scalars[k] += angle;
}

void leave_out_norths(graph::Graph& graph, std::size_t end) {
  if (graph.compasses.empty()) return;
  const double sigma = graph.compasses.front().sigma_rad;  // a world begins with it
  std::erase_if(graph.compasses, [end](const graph::CompassFactor& f) { return f.j < end; });
  if (graph.compasses.empty()) return;
  const graph::CompassFactor first = graph.compasses.front();
  if (first.i != first.j)
    graph.compasses.insert(graph.compasses.begin(),
                           {first.i, first.i, first.north, first.q_odom_i, first.q_odom_i, 0.0, sigma});
  graph.scalar_priors.front().mean = graph.scalars[kRate];

  const std::size_t gone = first.north - kFirstNorth;
  const auto norths = graph.scalars.begin() + static_cast<std::ptrdiff_t>(kFirstNorth);
  graph.scalars.erase(norths, norths + static_cast<std::ptrdiff_t>(gone));
  std::erase_if(graph.drifts, [&](const graph::DriftFactor& f) { return f.a < first.north; });
  for (auto& f : graph.drifts) f.a -= gone, f.b -= gone;
  for (auto& f : graph.compasses) f.north -= gone;
}

}  // namespace kinemap
