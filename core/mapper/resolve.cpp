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
constexpr double kSeam = 0.2;         // s that the pause is made to last, for the extraction only
constexpr double kLeastShare = 0.15;  // of the contacts on the object come from either gesture

/// Which ends of a trace also lose the hand's way along a level surface.
enum class CutWay : std::uint8_t { Neither, First, Last };

/// The trace without the reach at both ends.
Trace without_ends(const Trace& trace, const std::vector<TracePoint>& points, const LandmarkConfig& config,
                   CutWay cut) {
  IndexRange kept = without_reach(points, config);
  std::vector<Eigen::Vector2d> flat;
  for (std::size_t i = kept.begin; i < kept.end; ++i) flat.emplace_back(points[i].p.head<2>());
  const IndexRange drawn = without_way(flat, config);
  if (cut == CutWay::Last) kept.end = kept.begin + drawn.end;
  if (cut == CutWay::First) kept.begin += drawn.begin;
  Trace out = trace;
  out.contacts.assign(trace.contacts.begin() + static_cast<std::ptrdiff_t>(kept.begin),
                      trace.contacts.begin() + static_cast<std::ptrdiff_t>(kept.end));
  return out;
}

/// Whether the joined extraction is one rectangle on which both gestures touched.
bool is_one_rectangle(const Extraction& extraction, std::size_t seam) {
  if (extraction.observations.size() != 1) return false;
  const Observation& seen = extraction.observations[0];
  if (seen.landmark.kind == graph::LandmarkKind::Wall) return false;
  const auto before =
      std::count_if(seen.contacts.begin(), seen.contacts.end(), [&](std::size_t i) { return i < seam; });
  const double share = static_cast<double>(before) / static_cast<double>(seen.contacts.size());
  return share >= kLeastShare && share <= 1.0 - kLeastShare;
}

}  // namespace

ResolvedTrace TraceResolver::resolve(const Trace& trace, const graph::Graph& graph, std::size_t touch, double floor_z) {
  ResolvedTrace alone{trace, trace_points(trace, graph, touch), {}, false};
  alone.extraction = extract_landmarks(alone.points, floor_z, config_);
  const std::optional<Trace> before = std::exchange(open_, std::nullopt);
  if (!alone.extraction.observations.empty()) return alone;
  open_ = trace;
  if (!before || trace.begin_s - before->end_s > kSoon) return alone;

  for (const bool way : {false, true}) {
    if (auto both = joined(*before, trace, graph, touch, floor_z, way)) {
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

std::optional<ResolvedTrace> TraceResolver::joined(const Trace& before, const Trace& after, const graph::Graph& graph,
                                                   std::size_t touch, double floor_z, bool with_way) const {
  ResolvedTrace both{
      without_ends(before, trace_points(before, graph, touch), config_, with_way ? CutWay::Neither : CutWay::Last),
      {},
      {},
      true};
  const std::size_t seam = both.trace.contacts.size();
  const Trace next =
      without_ends(after, trace_points(after, graph, touch), config_, with_way ? CutWay::Neither : CutWay::First);
  both.trace.contacts.insert(both.trace.contacts.end(), next.contacts.begin(), next.contacts.end());
  both.trace.end_s = after.end_s;
  both.points = trace_points(both.trace, graph, touch);
  if (seam == 0 || seam == both.points.size() || (both.points[seam].p - both.points[seam - 1].p).norm() > kNear)
    return std::nullopt;
  auto without_pause = both.points;
  const double pause = both.points[seam].time_s - both.points[seam - 1].time_s - kSeam;
  for (std::size_t i = seam; i < without_pause.size(); ++i) without_pause[i].time_s -= pause;
  both.extraction = extract_landmarks(without_pause, floor_z, config_);
  if (!is_one_rectangle(both.extraction, seam)) return std::nullopt;
  return both;
}

}  // namespace kinemap
