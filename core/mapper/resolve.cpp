// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/resolve.hpp"

#include <algorithm>
#include <utility>

#include "core/landmarks/corners.hpp"
#include "core/mapper/observe.hpp"

namespace kinemap {
namespace {

constexpr double kSoon = 60.0;        // s from the end of one gesture to the beginning of the next
constexpr double kNear = 0.4;         // m from the last contact of the one to the first of the next
constexpr double kPause = 0.2;        // s that the pause is made to last, for the extraction only
constexpr double kLeastShare = 0.15;  // of the contacts on the object come from either gesture

/// What of two gestures counts where the one ends and the other begins.
enum class Seam : std::uint8_t {
  WithoutWay,  ///< not the hand's way along the level surface, to it and from it
  WithWay,
  OnSurface  ///< what lies on the surface that was made out in each alone: the hand was lowered between them, say
};
constexpr Seam kSeams[] = {Seam::WithoutWay, Seam::WithWay, Seam::OnSurface};

/// The gesture without what is no contact at its ends.
Trace without_ends(const ResolvedTrace& gesture, const LandmarkConfig& config, Seam seam, bool first) {
  const Trace& trace = gesture.trace;
  IndexRange kept = seam == Seam::OnSurface ? gesture.extraction.tried : without_reach(gesture.points, config);
  if (seam == Seam::WithoutWay) {
    std::vector<Eigen::Vector2d> flat;
    for (std::size_t i = kept.begin; i < kept.end; ++i) flat.emplace_back(gesture.points[i].p.head<2>());
    const IndexRange drawn = without_way(flat, config);
    if (first)
      kept.end = kept.begin + drawn.end;
    else
      kept.begin += drawn.begin;
  }
  Trace out = trace;
  out.contacts.assign(trace.contacts.begin() + static_cast<std::ptrdiff_t>(kept.begin),
                      trace.contacts.begin() + static_cast<std::ptrdiff_t>(kept.end));
  return out;
}

/// Whether the joined extraction is one rectangle on which both gestures touched; the contacts of the second one begin
/// at `second`.
bool is_one_rectangle(const Extraction& extraction, std::size_t second) {
  if (extraction.observations.size() != 1) return false;
  const Observation& seen = extraction.observations[0];
  if (seen.landmark.kind == graph::LandmarkKind::Wall) return false;
  const auto before =
      std::count_if(seen.contacts.begin(), seen.contacts.end(), [&](std::size_t i) { return i < second; });
  const double share = static_cast<double>(before) / static_cast<double>(seen.contacts.size());
  return share >= kLeastShare && share <= 1.0 - kLeastShare;
}

/// Both gestures, in neither of which anything was found, as one, if one rectangle was drawn in them.
std::optional<ResolvedTrace> joined(const ResolvedTrace& before, const ResolvedTrace& after, const graph::Graph& graph,
                                    std::size_t touch, double floor_z, LandmarkConfig config, Seam seam) {
  ResolvedTrace both{without_ends(before, config, seam, true), {}, {}, true};
  const std::size_t second = both.trace.contacts.size();
  const Trace next = without_ends(after, config, seam, false);
  both.trace.contacts.insert(both.trace.contacts.end(), next.contacts.begin(), next.contacts.end());
  both.trace.end_s = after.trace.end_s;
  both.points = trace_points(both.trace, graph, touch);
  if (second == 0 || second == both.points.size() || (both.points[second].p - both.points[second - 1].p).norm() > kNear)
    return std::nullopt;
  auto without_pause = both.points;
  const double pause = both.points[second].time_s - both.points[second - 1].time_s - kPause;
  for (std::size_t i = second; i < without_pause.size(); ++i) without_pause[i].time_s -= pause;
  if (seam == Seam::OnSurface) config.reach_max_s = 0.0;  // no reach is left
  both.extraction = extract_landmarks(without_pause, floor_z, config);
  if (!is_one_rectangle(both.extraction, second)) return std::nullopt;
  return both;
}

}  // namespace

ResolvedTrace TraceResolver::resolve(const Trace& trace, const graph::Graph& graph, std::size_t touch, double floor_z) {
  const auto resolved = [&](const Trace& gesture) {
    ResolvedTrace out{gesture, trace_points(gesture, graph, touch), {}, false};
    out.extraction = extract_landmarks(out.points, floor_z, config_);
    return out;
  };
  ResolvedTrace alone = resolved(trace);
  const std::optional<Trace> before = std::exchange(open_, std::nullopt);
  if (!alone.extraction.observations.empty()) return alone;
  open_ = trace;
  if (!before || trace.begin_s - before->end_s > kSoon) return alone;

  const ResolvedTrace first = resolved(*before);  // again: the map has moved since
  for (const Seam seam : kSeams) {
    if (auto both = joined(first, alone, graph, touch, floor_z, config_, seam)) {
      open_.reset();
      return *both;
    }
  }
  return alone;
}

void TraceResolver::renumber(std::size_t first, std::size_t fewer) {
  if (!open_) return;
  for (HandContact& contact : open_->contacts) {
    if (contact.key_pose < first) return open_.reset();
    contact.key_pose -= static_cast<KeyPoseId>(fewer);
  }
}

}  // namespace kinemap
