// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/mapper.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/mapper/checkpoint.hpp"
#include "core/mapper/closure.hpp"
#include "core/mapper/noise.hpp"
#include "core/mapper/observe.hpp"
#include "core/mapper/odometry.hpp"
#include "core/mapper/pose_covariance.hpp"
#include "core/mapper/publish.hpp"
#include "core/mapper/relocate.hpp"
#include "core/mapper/resolve.hpp"
#include "core/mapper/rooms.hpp"
#include "core/mapper/settled.hpp"
#include "core/mapper/touch.hpp"
#include "core/mapper/walls.hpp"
#include "core/mapper/wearers.hpp"

namespace kinemap {

class Mapper::Impl {
 public:
  Impl(const MapperConfig& config, std::uint64_t revision)
      : config_(config),
        odometry_(config.odometry),
        resolver_(config.landmarks),
        closer_(config),
        wearers_(config.hand),
        pelvis_covariance_(config.odometry) {
    renew_touch_priors();
    auto empty = std::make_shared<MapSnapshot>();
    empty->revision = revision;
    snapshot_ = std::move(empty);
  }

  void set_wearer(const WearerInfo& wearer) { wearers_.tell(wearer); }

  bool add(const KeyPose& key_pose) {
    odometry_.add(key_pose, state_.graph);
    if (const auto& way = state_.graph.between; !way.empty())
      pelvis_covariance_.add(state_.graph.poses[way.back().i], way.back().T_i_j,
                             step_sigma(state_.graph, way.back(), noise_));
    time_s_ = key_pose.time_s;
    if (key_pose.id + 1 < snapshot_->graph.key_poses + kTrajectoryLag) return false;
    publish(std::make_shared<MapSnapshot>(*snapshot_));  // the objects are as they were
    return true;
  }

  bool add(const Trace& as_told) {
    Trace trace = as_told;
    for (HandContact& contact : trace.contacts) contact.key_pose = pose_of(contact.key_pose);
    time_s_ = trace.end_s;
    touched_ = true;
    const std::size_t wearer = meet(trace.stature_m);
    const auto found = resolver_.resolve(trace, state_.graph, wearer, odometry_.floor_z());
    if (found.joined) unresolved_.pop_back();  // the trace before was its beginning
    if (found.extraction.observations.empty())
      unresolved_.push_back({trace.begin_s, trace.end_s, found.extraction.reason});
    for (const auto& observation : found.extraction.observations)
      wearers_.touch(wearer).see(observation, found.trace, state_.graph);
    for (const auto& observation : found.extraction.observations)
      if (observation.landmark.kind != graph::LandmarkKind::Wall)
        odometry_.suspect_heading(trace.begin_s - kApproach, trace.end_s + config_.odometry.magnetic_after_s,
                                  state_.graph);
    // All of them before any is associated: that may move the graph, and `points` are where it was.
    std::vector<std::size_t> newcomers;
    for (const auto& observation : found.extraction.observations)
      newcomers.push_back(
          add_observation(observation, found.trace, found.points, wearer, odometry_.floor_z(), config_, state_));
    for (const std::size_t newcomer : newcomers) associate(newcomer);
    publish();
    return true;
  }

  bool add(const Pivot& pivot) {
    time_s_ = pivot.end_s;
    touched_ = true;
    wearers_.touch(meet(pivot.stature_m)).add(pivot);
    renew_touch_priors();
    publish();
    return true;
  }

  bool add(const Sitting& as_told) {
    Sitting sitting = as_told;
    sitting.key_pose = pose_of(sitting.key_pose);
    time_s_ = sitting.end_s;
    associate(add_seat(sitting, odometry_.floor_z(), config_, state_));
    publish();
    return true;
  }

  void finish(const std::function<bool()>& enough) {
    if (state_.graph.poses.empty()) return;
    closer_.settle(state_, config_.solver.final_iterations);
    if (judge_touch()) closer_.settle(state_, config_.solver.final_iterations);
    closer_.revise(state_, enough);
    if (closer_.reconsider(state_)) closer_.settle(state_, config_.solver.final_iterations);
    if (!enough || !enough()) noise_ = estimate_noise(state_.graph);
    publish();
  }

  [[nodiscard]] std::string checkpoint() {
    Archive archive;
    std::uint32_t version = kCheckpointVersion;
    std::uint64_t revision = snapshot_->revision;
    archive(version, revision, *this);
    return std::move(archive.bytes());
  }
  bool restore(std::string_view checkpoint) {
    Archive archive(checkpoint);
    std::uint32_t version = 0;
    std::uint64_t revision = 0;
    archive(version, revision);
    if (version != kCheckpointVersion) return false;
    archive(*this);
    if (!archive.whole()) return false;
    auto before = std::make_shared<MapSnapshot>();
    before->revision = revision - 1;
    snapshot_ = std::move(before);
    const PoseCovariance covariance = pelvis_covariance_;  // as carried on, which publishing takes from the graph anew
    publish();
    pelvis_covariance_ = covariance;
    return true;
  }
  void fields(Archive& a) {
    a(odometry_, resolver_, closer_, wearers_, pelvis_covariance_, touched_, state_, noise_, settled_way_, unresolved_,
      time_s_);
  }

  [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot() const { return snapshot_; }
  [[nodiscard]] const graph::Graph& graph() const { return state_.graph; }

 private:
  static constexpr double kApproach = 2.0;          ///< s that one stands at a table or screen before one traces it
  static constexpr std::size_t kLeastClosures = 2;  ///< that bear out how a part was laid on the map
  static constexpr std::size_t kTrajectoryLag =
      10;  ///< key poses after which a walk is published without news of objects

  /// Who draws now.
  std::size_t meet(std::optional<double> stature_m) {
    wearers_.meet(stature_m);
    renew_touch_priors();
    return wearers_.current();
  }

  /// What is expected of a hand changes as more becomes known of its wearer. What was estimated moves along until the
  /// next optimisation. True when one changed.
  bool renew_touch_priors() {
    auto& points = state_.graph.touch_points;
    bool changed = false;
    for (std::size_t k = 0; k < wearers_.count(); ++k) {
      graph::TouchPoint expected = wearers_.touch(k).prior();
      if (k == points.size()) points.push_back(expected);
      graph::TouchPoint& touch = points[k];
      const double shift = (expected.prior - touch.prior).norm() + (expected.sigma - touch.sigma).norm();
      if (shift < 1e-3) continue;
      expected.p_hand += touch.p_hand - touch.prior;
      touch = expected;
      changed = true;
    }
    return changed;
  }

  /// Tips or palm, by the optimum that was just reached. True when that changed what is expected of the hand.
  bool judge_touch() {
    const auto marginals = graph::Marginals::compute(state_.graph);
    if (!marginals) return false;
    for (std::size_t k = 0; k < wearers_.count(); ++k)
      wearers_.touch(k).judge(state_.graph.touch_points[k], touch_covariance(state_.graph, *marginals, k));
    return renew_touch_priors();
  }

  void associate(std::size_t newcomer) {
    const bool closed = closer_.resolve(state_, newcomer);
    if (!join_parts() && !closed) return;
    closer_.reconsider(state_);
    judge_touch();
  }

  /// Lays what was seen after a break on the map before it, once that is clear. True when it holds.
  bool join_parts() {
    const auto T_map_part = find_relocation(state_);
    if (!T_map_part) return false;
    MapState trial = state_;
    LoopCloser closer = closer_;
    relocate(trial, *T_map_part);
    closer.settle(trial, config_.solver.final_iterations);
    closer.reconsider(trial);
    if (trial.summary.loop_closures < state_.summary.loop_closures + kLeastClosures) return false;
    state_ = std::move(trial);
    closer_ = std::move(closer);
    return true;
  }

  /// Publishes the objects as the graph has them now.
  void publish() {
    auto map = std::make_shared<MapSnapshot>();
    const auto walls = cut_walls(state_, config_.walls);
    const graph::NoiseScales expected = std::exchange(state_.graph.noise, noise_);  // of this session, to be published
    const auto marginals = graph::Marginals::compute(state_.graph);
    map->objects = map_objects(state_, walls, marginals ? &*marginals : nullptr, config_);
    state_.graph.noise = expected;
    map->rooms = find_rooms(state_, walls, config_.walls);
    map->doorways = find_doorways(state_, walls, map->rooms);
    map->unresolved = unresolved_;
    if (marginals && !state_.graph.poses.empty())
      pelvis_covariance_.set(state_.graph.poses.back(), newest_marginal(state_.graph, *marginals));
    if (marginals && touched_) describe_hands(*marginals, *map);
    if (marginals) settle_way(*marginals);
    publish(std::move(map));
  }

  void describe_hands(const graph::Marginals& marginals, MapSnapshot& map) const {
    for (std::size_t k = 0; k < wearers_.count(); ++k) {
      const auto hand =
          describe_hand(wearers_.touch(k), state_.graph.touch_points[k], touch_covariance(state_.graph, marginals, k));
      if (k == wearers_.current()) map.hand = hand;
      if (wearers_.count() > 1) map.wearers.push_back({wearers_.info(k).name, wearers_.stature_m(k), hand});
    }
  }

  /// Publishes `map` with the trajectory up to now.
  void publish(std::shared_ptr<MapSnapshot> map) {
    map->revision = snapshot_->revision + 1;
    map->time_s = time_s_;
    const auto& key_poses = odometry_.key_poses();
    map->trajectory.reserve(state_.graph.poses.size());
    map->trajectory.assign(settled_way_.begin(), settled_way_.end());
    for (std::size_t k = settled_way_.empty() ? 0 : 1; k < key_poses.size(); ++k)
      map->trajectory.push_back(trajectory_pose(k));
    if (!key_poses.empty()) map->T_map_odom = state_.graph.poses.back() * key_poses.back().T_odom_pelvis.inverse();
    if (!key_poses.empty())
      map->pelvis_covariance =
          pelvis_covariance_.published(state_.graph.poses.back(), state_.graph.poses.front().p, noise_.way);
    map->graph = state_.summary;
    map->graph.key_poses = key_poses.empty() ? 0 : key_poses.back().id + std::size_t{1};
    map->graph.landmarks = map->objects.size();
    snapshot_ = std::move(map);
  }

  /// The pose of the graph for a key pose. Events refer to recent ones; for one that is settled and was left out it is
  /// the one kept before it, which is near.
  [[nodiscard]] KeyPoseId pose_of(KeyPoseId id) const {
    if (settled_way_.empty()) return id;
    const KeyPoseId newest_settled = settled_way_.back().id;
    const auto settled = static_cast<KeyPoseId>(settled_way_.size());
    if (id > newest_settled) return id - newest_settled - 1 + settled;
    const auto after = std::upper_bound(settled_way_.begin(), settled_way_.end(), id,
                                        [](KeyPoseId x, const TrajectoryPose& pose) { return x < pose.id; });
    return static_cast<KeyPoseId>(std::max<std::ptrdiff_t>(1, after - settled_way_.begin()) - 1);
  }

  /// The k-th key pose that odometry still has, as it is published.
  [[nodiscard]] TrajectoryPose trajectory_pose(std::size_t k) const {
    const KeyPose& key_pose = odometry_.key_poses()[k];
    return {key_pose.id, key_pose.time_s, state_.graph.poses[pose_of(key_pose.id)], key_pose.T_odom_pelvis,
            k == 0 ? StepSigma{} : step_sigma(state_.graph, state_.graph.between[k - 1])};
  }

  /// Takes the way of long ago out of the graph, where it is well known by now.
  void settle_way(const graph::Marginals& marginals) {
    const std::size_t end = first_unsettled_pose(state_, marginals, config_.solver);
    if (end == state_.graph.first_free_pose) return;
    const std::size_t begin = settled_way_.empty() ? 0 : settled_way_.size() - 1;  // of what odometry still has
    std::vector<TrajectoryPose> way;
    for (std::size_t k = 0; begin + k < end; ++k) way.push_back(trajectory_pose(k));
    std::vector<std::size_t> wanted;
    for (const ObservationRecord& visit : state_.observations)
      if (visit.key_pose >= begin) wanted.push_back(visit.key_pose - begin);
    std::sort(wanted.begin(), wanted.end());
    const std::vector<std::size_t> kept = poses_to_keep(way, wanted);

    std::vector<std::size_t> kept_in_graph(begin);
    std::iota(kept_in_graph.begin(), kept_in_graph.end(), std::size_t{0});
    for (const std::size_t k : kept) kept_in_graph.push_back(begin + k);
    if (!fold_settled(state_, end, kept_in_graph)) return;
    resolver_.renumber(end, end - kept_in_graph.size());
    if (!settled_way_.empty()) way.front() = settled_way_.back(), settled_way_.pop_back();
    const auto kept_way = thinned(way, kept);
    settled_way_.insert(settled_way_.end(), kept_way.begin(), kept_way.end());
    odometry_.forget(way.size() - 1);
  }

  MapperConfig config_;
  Odometry odometry_;
  TraceResolver resolver_;
  LoopCloser closer_;
  Wearers wearers_;
  PoseCovariance pelvis_covariance_;
  bool touched_ = false;  ///< a trace or pivot gesture has been seen
  MapState state_;
  graph::NoiseScales noise_;                 ///< as last estimated, for what is published
  std::vector<TrajectoryPose> settled_way_;  ///< of the graph's constant poses; the last is odometry's first
  std::vector<UnresolvedTrace> unresolved_;
  double time_s_ = 0.0;
  std::shared_ptr<const MapSnapshot> snapshot_;
};

Mapper::Mapper(const MapperConfig& config, std::uint64_t revision) : impl_(std::make_unique<Impl>(config, revision)) {}
Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

void Mapper::set_wearer(const WearerInfo& wearer) { impl_->set_wearer(wearer); }
bool Mapper::add(const Event& event) {
  return std::visit([this](const auto& e) { return impl_->add(e); }, event);
}
void Mapper::finish(const std::function<bool()>& enough) { impl_->finish(enough); }
std::string Mapper::checkpoint() const { return impl_->checkpoint(); }
std::optional<Mapper> Mapper::restore(const MapperConfig& config, std::string_view checkpoint) {
  Mapper mapper(config);
  if (!mapper.impl_->restore(checkpoint)) return std::nullopt;
  return mapper;
}
std::shared_ptr<const MapSnapshot> Mapper::snapshot() const { return impl_->snapshot(); }
const graph::Graph& Mapper::graph() const { return impl_->graph(); }

}  // namespace kinemap
