// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/events.hpp"
#include "core/landmarks/extract.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// The contacts of a trace as points of the touching hand, in the map as the graph has it now: the drift inside the
/// trace that is already known is taken out before a landmark is fitted.
std::vector<TracePoint> trace_points(const Trace& trace, const graph::Graph& graph, std::size_t touch);

/// Sine of the angle at which the fingers point into the surface at a contact: 0 a flat hand, 1 at a right angle.
double fingers_into(const graph::Landmark& landmark, const HandContact& contact, const graph::Graph& graph);

/// Appends the observation as a landmark of its own, with one contact factor for each thinned contact. Returns the
/// landmark's index.
std::size_t add_observation(const Observation& observation, const Trace& trace, const std::vector<TracePoint>& points,
                            std::size_t touch, double floor_z, const MapperConfig& config, MapState& state);

/// Appends a seat as a landmark of its own. Returns the landmark's index.
std::size_t add_seat(const Sitting& sitting, double floor_z, const MapperConfig& config, MapState& state);

}  // namespace kinemap
