// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/landmarks/extract.hpp"

namespace kinemap {

/// A trace with what was found in it. `joined`: together with the trace before, in which nothing had been found;
/// `trace` holds the contacts of both then.
struct ResolvedTrace {
  Trace trace;
  std::vector<TracePoint> points;  ///< of the contacts of `trace`, in the map as the graph has it
  Extraction extraction;
  bool joined = false;
};

/// Finds the objects of traces. One object may be drawn in two gestures (the left hand comes down at a corner of a
/// table, a screen's contour is interrupted): a trace in which nothing was found is kept, and tried together with the
/// next one when that goes on soon and near, and holds nothing by itself either.
class TraceResolver {
 public:
  explicit TraceResolver(const LandmarkConfig& config) : config_(config) {}

  /// `touch` indexes the graph's touching points; `floor_z` in the map frame, m.
  ResolvedTrace resolve(const Trace& trace, const graph::Graph& graph, std::size_t touch, double floor_z);

  /// Poses of the graph have been left out: those from `first` on have numbers that are less by `fewer`.
  void renumber(std::size_t first, std::size_t fewer);

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(open_);
  }

 private:
  LandmarkConfig config_;
  std::optional<Trace> open_;  ///< the trace before, when nothing was found in it
};

}  // namespace kinemap
