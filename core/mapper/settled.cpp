// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/settled.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/graph/fold.hpp"
#include "core/mapper/associate.hpp"
#include "core/mapper/compass.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kProbe = 50;     // every so many key poses the way is looked at
constexpr double kKnown = 0.3;         // m: standard deviation of a place that is well known
constexpr double kOffWay = 0.08;       // m: a pose so near to where it would be looked for is not kept
constexpr double kOffHeading = 0.35;   // rad
constexpr std::size_t kLongest = 200;  // key poses between two that are kept

struct Range {
  std::size_t first, last;
};

/// The poses from which a visit that is not settled was made.
Range poses_of(const MapState& state, const ObservationRecord& visit) {
  Range range{visit.key_pose, visit.key_pose};
  for (std::size_t k = visit.first_contact; k < visit.first_contact + visit.contacts; ++k) {
    range.first = std::min(range.first, state.graph.contacts[k].i);
    range.last = std::max(range.last, state.graph.contacts[k].i);
  }
  return range;
}

/// The last place at `end` or before it where no visit is cut in two.
std::size_t between_visits(const MapState& state, std::size_t end) {
  for (bool moved = true; moved;) {
    moved = false;
    for (const ObservationRecord& visit : state.observations) {
      if (visit.settled) continue;
      const Range range = poses_of(state, visit);
      if (range.first >= end || range.last < end) continue;
      end = range.first;
      moved = true;
    }
  }
  return std::max(end, state.graph.first_free_pose);
}

bool on_the_way(const TrajectoryPose& a, const TrajectoryPose& b, const TrajectoryPose& pose) {
  const double t = (pose.time_s - a.time_s) / std::max(1e-9, b.time_s - a.time_s);
  const Eigen::Vector3d p = a.T_map_pelvis.p + t * (b.T_map_pelvis.p - a.T_map_pelvis.p);
  return (pose.T_map_pelvis.p - p).norm() < kOffWay &&
         a.T_map_pelvis.q.slerp(t, b.T_map_pelvis.q).angularDistance(pose.T_map_pelvis.q) < kOffHeading;
}

/// The ends of what a visit touched of a wall.
std::optional<std::array<Eigen::Vector3d, 2>> ends_of(const MapState& state, const ObservationRecord& visit) {
  const graph::Landmark& landmark = state.graph.landmarks[visit.landmark];
  if (landmark.kind != graph::LandmarkKind::Wall) return std::nullopt;
  const WallFrame frame(landmark);
  const auto touched = contact_interval(state, visit, frame);
  if (!touched) return std::nullopt;
  return std::array{frame.point(touched->lo), frame.point(touched->hi)};
}

/// Appends the contacts and the seat of a visit to another graph; the visit refers to these then.
void move_factors(const graph::Graph& from, ObservationRecord& visit, graph::Graph& to) {
  const auto first = from.contacts.begin() + static_cast<std::ptrdiff_t>(visit.first_contact);
  if (visit.has_seat()) {
    to.seats.push_back(from.seats[visit.seat]);
    visit.seat = to.seats.size() - 1;
  }
  visit.first_contact = to.contacts.size();
  to.contacts.insert(to.contacts.end(), first, first + static_cast<std::ptrdiff_t>(visit.contacts));
}

/// Numbers of poses after those before `end` have been left out but for `kept`.
class Renumbering {
 public:
  Renumbering(std::size_t end, const std::vector<std::size_t>& kept) : end_(end), kept_(kept) {}
  /// Of a pose that is there still, or of the next one that is.
  [[nodiscard]] std::size_t operator()(std::size_t pose) const {
    if (pose >= end_) return pose - end_ + kept_.size();
    return static_cast<std::size_t>(std::lower_bound(kept_.begin(), kept_.end(), pose) - kept_.begin());
  }

 private:
  std::size_t end_;
  const std::vector<std::size_t>& kept_;
};

template <class Factor>
void keep_free(std::vector<Factor>& factors, std::size_t end, const Renumbering& renumbered) {
  std::erase_if(factors, [end](const Factor& f) { return f.i < end; });
  for (Factor& f : factors) f.i = renumbered(f.i);
}

/// Leaves out the poses, and the factors between them alone.
void leave_out(graph::Graph& graph, std::size_t end, const std::vector<std::size_t>& kept) {
  const Renumbering renumbered(end, kept);
  std::vector<Pose> poses;
  for (const std::size_t i : kept) poses.push_back(graph.poses[i]);
  poses.insert(poses.end(), graph.poses.begin() + static_cast<std::ptrdiff_t>(end), graph.poses.end());
  graph.poses = std::move(poses);
  graph.first_free_pose = kept.size();
  keep_free(graph.gravity, end, renumbered);
  keep_free(graph.floors, end, renumbered);
  keep_free(graph.priors, end, renumbered);
  std::erase_if(graph.between, [end](const graph::BetweenFactor& f) { return f.j < end; });
  for (auto& f : graph.between) f.i = renumbered(f.i), f.j = renumbered(f.j);
  leave_out_norths(graph, end);
  for (auto& f : graph.compasses) f.i = renumbered(f.i), f.j = renumbered(f.j);
  for (auto& f : graph.contacts) f.i = renumbered(f.i);
  for (auto& f : graph.seats) f.i = renumbered(f.i);
  std::erase_if(graph.landmark_priors,
                [&](const graph::LandmarkPrior& f) { return !graph.landmarks[f.landmark].active; });
}

}  // namespace

std::size_t first_unsettled_pose(const MapState& state, const graph::Marginals& marginals,
                                 const MapperConfig::Solver& config) {
  const graph::Graph& graph = state.graph;
  const auto most = static_cast<std::size_t>(config.most_free_key_poses);
  const auto kept = static_cast<std::size_t>(config.kept_free_key_poses);
  if (graph.poses.size() - graph.first_free_pose < std::max(most, kept)) return graph.first_free_pose;
  const std::size_t end = graph.poses.size() - kept;
  std::size_t settled = graph.first_free_pose;
  for (std::size_t i = settled; i < end; i += kProbe) {
    const graph::Variable pose{graph::Variable::Kind::Pose, i};
    if (marginals.joint({&pose, 1}).topLeftCorner<2, 2>().trace() > 2.0 * kKnown * kKnown) break;
    settled = i;
  }
  return between_visits(state, settled);
}

std::vector<std::size_t> poses_to_keep(const std::vector<TrajectoryPose>& way, const std::vector<std::size_t>& wanted) {
  std::vector<std::size_t> kept{0};
  auto next = wanted.begin();
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    while (next != wanted.end() && *next < i) ++next;
    bool needed = (next != wanted.end() && *next == i) || i + 1 - kept.back() > kLongest;
    for (std::size_t k = kept.back() + 1; k <= i && !needed; ++k)
      needed = !on_the_way(way[kept.back()], way[i + 1], way[k]);
    if (needed) kept.push_back(i);
  }
  if (way.size() > 1) kept.push_back(way.size() - 1);
  return kept;
}

std::vector<TrajectoryPose> thinned(const std::vector<TrajectoryPose>& way, const std::vector<std::size_t>& kept) {
  std::vector<TrajectoryPose> out;
  for (const std::size_t to : kept) {
    TrajectoryPose pose = way[to];
    for (std::size_t k = out.empty() ? to : kept[out.size() - 1] + 1; k < to; ++k) {
      const StepSigma& step = way[k].step;
      pose.step.level_m = std::hypot(pose.step.level_m, step.level_m);
      pose.step.up_m = std::hypot(pose.step.up_m, step.up_m);
      pose.step.tilt_rad = std::hypot(pose.step.tilt_rad, step.tilt_rad);
      pose.step.heading_rad = std::hypot(pose.step.heading_rad, step.heading_rad);
    }
    out.push_back(pose);
  }
  return out;
}

bool fold_settled(MapState& state, std::size_t end, const std::vector<std::size_t>& kept) {
  graph::Graph settled, free;  // observations only
  settled.poses = state.graph.poses;
  settled.landmarks = state.graph.landmarks;
  settled.touch_points = state.graph.touch_points;
  settled.folded = state.graph.folded;
  const Renumbering renumbered(end, kept);
  std::vector<ObservationRecord> observations = state.observations;
  for (ObservationRecord& visit : observations) {
    if (!visit.settled) {
      const Range range = poses_of(state, visit);
      if (range.last >= end) {
        move_factors(state.graph, visit, free);
      } else {
        const auto touched = ends_of(state, visit);
        move_factors(state.graph, visit, settled);
        const std::size_t after = renumbered(range.last + 1);
        visit.settled =
            SettledVisit{renumbered(range.first), std::max(after, renumbered(visit.key_pose) + 1) - 1, touched};
        visit.first_contact = visit.contacts = visit.seat = 0;
      }
    }
    visit.key_pose = renumbered(visit.key_pose);
  }
  auto folded = graph::fold(std::move(settled));
  if (!folded) return false;
  state.observations = std::move(observations);
  state.graph.contacts = std::move(free.contacts);
  state.graph.seats = std::move(free.seats);
  state.graph.folded = *std::move(folded);
  leave_out(state.graph, end, kept);
  return true;
}

}  // namespace kinemap
