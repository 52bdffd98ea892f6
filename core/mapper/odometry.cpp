// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/odometry.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach.hpp"

namespace kinemap {
namespace {

constexpr double kStep = 0.08;       // m: a stance foot that is farther from the one before has climbed a step
constexpr int kSteadyStances = 3;    // so many level stances in a row are a level
constexpr double kLeastStood = 0.5;  // of a step; of less the feet cannot tell how far the body turned
constexpr double kSameLevel = 0.15;  // m: closer to a known level than this is that level

// What a wearer may have done unseen, at a break in odometry; standard deviations.
constexpr double kUnseenWalk = 1.0;       // m/s …
constexpr double kUnseenWalkMost = 10.0;  // m
constexpr double kUnseenClimb = 0.1;      // m/s: sat down, stood up; stays on its floor …
constexpr double kUnseenClimbMost = 0.3;  // m
constexpr double kUnseenTurn = 0.5;       // rad/s …
constexpr double kUnseenTurnMost = 2.0;   // rad: any heading
constexpr double kJolt = 0.03;            // m, rad: what is not known even of one frame to the next
constexpr double kOrigin = 1.5;           // m level: a suit that is set up anew begins so near to its origin

double squared(double x) { return x * x; }

double grown(double rate, double seconds, double most) { return std::min(std::hypot(kJolt, rate * seconds), most); }

graph::Matrix6 break_sqrt_information(double seconds, const MapperConfig::Odometry& config) {
  const double level = grown(kUnseenWalk, seconds, kUnseenWalkMost);
  const double up = grown(kUnseenClimb, seconds, kUnseenClimbMost);
  const double heading = grown(kUnseenTurn, seconds, kUnseenTurnMost);
  graph::Matrix6 information = graph::Matrix6::Zero();
  information.diagonal() << 1.0 / level, 1.0 / level, 1.0 / up, 1.0 / config.tilt_rad, 1.0 / config.tilt_rad,
      1.0 / heading;
  return information;
}

/// After a break: whether the suit's world may still be the old one (some of the way is missing in the journal, or its
/// stream was interrupted). Where it may have begun anew as well, it is taken for another one: that the body stayed is
/// nearly right for both.
bool same_world(const KeyPose& from, const KeyPose& to) {
  const Pose& a = from.T_odom_pelvis;
  const Pose& b = to.T_odom_pelvis;
  const bool began_anew = b.p.head<2>().norm() < kOrigin;
  return !began_anew && within_reach(a, b, to.time_s - from.time_s);
}

/// Part of a step during which feet stood and were heard.
double stood_share(const KeyPose& from, const KeyPose& to) {
  return to.slip ? std::clamp(to.slip->stood_s / seconds_between(from, to), 0.0, 1.0) : 0.0;
}

/// What the feet count beside the suit, on the way that they stood on.
double weight_of_feet(const MapperConfig::Odometry& config) {
  const double suit = squared(config.translation_m_per_sqrt_m), feet = squared(config.feet_m_per_sqrt_m);
  return suit > 0.0 ? suit / (suit + feet) : 0.0;
}

/// Standard deviation of the turn as the feet saw it (rad); nullopt when they did not see enough of it.
std::optional<double> turn_sigma(const KeyPose& from, const KeyPose& to, const MapperConfig::Odometry& config) {
  const double share = stood_share(from, to);
  if (to.discontinuity || share < kLeastStood) return std::nullopt;
  const double seconds = seconds_between(from, to);
  const double unseen = 2.0 * squared(config.heading_rad_per_sqrt_s) * (1.0 - share) * seconds;
  return std::sqrt(squared(config.feet_rad_per_sqrt_s) * seconds + squared(to.slip->apart_rad) + unseen);
}

}  // namespace

Pose odometry_step(const KeyPose& from, const KeyPose& to, const MapperConfig::Odometry& config) {
  const Pose& before = from.T_odom_pelvis;
  Pose after = to.T_odom_pelvis;
  if (to.discontinuity && !same_world(from, to)) return before.inverse() * stayed(before, after);
  if (to.slip) {
    after.p.head<2>() += weight_of_feet(config) * to.slip->way_m;
    if (turn_sigma(from, to, config))
      after.q = Eigen::AngleAxisd(to.slip->turn_rad, Eigen::Vector3d::UnitZ()) * after.q;
  }
  return before.inverse() * after;
}

graph::Matrix6 odometry_sqrt_information(const KeyPose& from, const KeyPose& to, const MapperConfig::Odometry& config) {
  if (to.discontinuity) return break_sqrt_information(to.time_s - from.time_s, config);
  const double dt = seconds_between(from, to);
  const double feet = stood_share(from, to) * weight_of_feet(config);
  const double level = std::sqrt((1.0 - feet) * squared(config.translation_m_per_sqrt_m) * to.path_m +
                                 squared(config.translation_m_per_sqrt_s) * dt + squared(0.001));
  const double up = std::sqrt(squared(config.vertical_m_per_sqrt_m) * to.path_m +
                              squared(config.translation_m_per_sqrt_s) * dt + squared(0.001));
  graph::Matrix6 information = graph::Matrix6::Zero();
  const auto turn = turn_sigma(from, to, config);
  information.diagonal() << 1.0 / level, 1.0 / level, 1.0 / up, 1.0 / config.tilt_rad, 1.0 / config.tilt_rad,
      turn ? 1.0 / *turn : 0.0;
  return information;
}

void Odometry::add(const KeyPose& key_pose, graph::Graph& graph) {
  if (key_poses_.empty()) {
    graph.poses.push_back(key_pose.T_odom_pelvis);  // the map frame is the suit's world frame at the first frame
    graph::PriorFactor prior;
    prior.T_map_i = key_pose.T_odom_pelvis;
    prior.sqrt_information = graph::Matrix6::Identity() * 1e4;
    graph.priors.push_back(prior);
    compass_.begin(key_pose, 0, graph);
  } else {
    add_between(key_pose, graph);
  }
  graph::GravityFactor gravity;
  gravity.i = graph.poses.size() - 1;
  gravity.up = key_pose.T_odom_pelvis.q.conjugate() * Eigen::Vector3d::UnitZ();
  gravity.sigma_rad = config_.tilt_rad;
  graph.gravity.push_back(gravity);
  add_floor(key_pose, graph);
  key_poses_.push_back(key_pose);
}

void Odometry::add_between(const KeyPose& key_pose, graph::Graph& graph) {
  if (key_pose.field_disturbed.value_or(false)) suspect_until_s_ = key_pose.time_s + config_.magnetic_after_s;
  const KeyPose& from = key_poses_.back();
  graph::BetweenFactor between;
  between.i = graph.poses.size() - 1;
  between.j = graph.poses.size();
  between.T_i_j = odometry_step(from, key_pose, config_);
  between.sqrt_information = odometry_sqrt_information(from, key_pose, config_);
  graph.between.push_back(between);
  graph.poses.push_back(graph.poses.back() * between.T_i_j);
  if (key_pose.discontinuity)
    compass_.begin(key_pose, between.j, graph);
  else
    compass_.add(from, key_pose, between.i, between.j, key_pose.time_s <= suspect_until_s_, graph);
}

void Odometry::suspect_heading(double begin_s, double end_s, graph::Graph& graph) {
  if (key_poses_.empty() || !key_poses_.back().field_disturbed) suspect_until_s_ = std::max(suspect_until_s_, end_s);
  for (auto f = graph.compasses.rbegin(); f != graph.compasses.rend(); ++f) {
    const std::size_t k = key_poses_.size() - (graph.poses.size() - f->j);
    if (key_poses_[k].time_s <= begin_s) return;
    if (f->i != f->j && key_poses_[k].time_s < end_s && !key_poses_[k].field_disturbed)
      f->sigma_rad = heading_sigma(key_poses_[k - 1], key_poses_[k], true, config_);
  }
}

void Odometry::add_floor(const KeyPose& key_pose, graph::Graph& graph) {
  if (key_pose.discontinuity) {
    last_stance_z_.reset();  // of another world
    off_level_ = 0.0;        // assume that a restart did not change the floor
  }
  if (!key_pose.p_pelvis_stance) return;
  const double z_odom = (key_pose.T_odom_pelvis * *key_pose.p_pelvis_stance).z();
  const double step = last_stance_z_ ? z_odom - *last_stance_z_ : 0.0;
  last_stance_z_ = z_odom;
  if (levels_.empty()) {
    level_z_ = z_odom;
    levels_.push_back(level_z_);
    on_level_ = true;
  } else if (std::abs(step) > kStep || !on_level_) {
    off_level_ += step;
    steady_ = std::abs(step) > kStep ? 0 : steady_ + 1;
    on_level_ = steady_ >= kSteadyStances;
    if (!on_level_) return;
    const double z = level_z_ + off_level_;
    const auto known = std::min_element(levels_.begin(), levels_.end(),
                                        [z](double a, double b) { return std::abs(a - z) < std::abs(b - z); });
    if (std::abs(*known - z) < kSameLevel)
      level_z_ = *known;
    else
      levels_.push_back(level_z_ = z);
    off_level_ = 0.0;
  }
  graph::FloorFactor floor;
  floor.i = graph.poses.size() - 1;
  floor.p_i = *key_pose.p_pelvis_stance;
  floor.z = level_z_;
  floor.sigma_m = config_.floor_m;
  floor.loss = {graph::Loss::Kind::Huber, 2.0};
  graph.floors.push_back(floor);
  // The height is known at once; waiting for the next optimisation would let the vertical drift into the next object.
  Pose& pose = graph.poses.back();
  pose.p.z() += level_z_ - (pose * floor.p_i).z();
}

StepSigma step_sigma(const graph::Graph& graph, const graph::BetweenFactor& between, const graph::NoiseScales& noise) {
  const graph::Matrix6& information = between.sqrt_information;  // diagonal
  const auto compass = std::lower_bound(graph.compasses.begin(), graph.compasses.end(), between.j,
                                        [](const graph::CompassFactor& f, std::size_t pose) { return f.j < pose; });
  const double compass_information = compass->i != compass->j ? 1.0 / (noise.heading * compass->sigma_rad) : 0.0;
  const double heading = 1.0 / std::hypot(compass_information, information(5, 5));
  return {noise.way / information(0, 0), noise.way / information(2, 2), 1.0 / information(3, 3), heading};
}

}  // namespace kinemap
