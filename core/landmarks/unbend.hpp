// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/landmarks/surface.hpp"

namespace kinemap {

/// The trace as it would be had the heading not turned at `rate` (rad/s, about z) while it was drawn: body and hand are
/// turned back by what the heading had turned since the middle of the trace, where both stay as they are.
std::vector<TracePoint> unbent(std::span<const TracePoint> points, double rate);

/// Metal draws the heading of the suit to a wrong north by up to 35° with a time constant of 10 s and more: a contour
/// drawn beside it is bent. Returns the rate (rad/s) without which the trace makes most sense, 0 when none makes it
/// clearly better: `misfit(points)` is the mean square distance of the contacts from what was drawn, m², infinite where
/// nothing fits.
double heading_rate(std::span<const TracePoint> points,
                    const std::function<double(std::span<const TracePoint>)>& misfit);

}  // namespace kinemap
