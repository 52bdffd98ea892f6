// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/composer.hpp"

namespace kinemap::sim {

/// How much of a wall to touch: every free stretch, the longest one, or a part of that to touch again what is known.
enum class WallExtent : std::uint8_t { All, Longest, Brief };

// Each returns the ids of what was drawn; none when nothing could be reached.

/// Runs the right hand along a face of a wall, from one end to the other or between what stands there; one gesture for
/// each free stretch of at least 0.8 m.
std::vector<int> trace_wall(Composer& composer, const WallFace& wall, bool wall_at_right, WallExtent extent);

/// Along `first` into the corner where `second` begins and on along that, in one gesture. Nothing when a doorway or
/// furniture is in that corner.
std::vector<int> trace_wall_corner(Composer& composer, const WallFace& first, const WallFace& second,
                                   bool wall_at_right);

/// Along two adjacent edges of a table top (from a far corner round the near one to the other far one), three, or the
/// whole contour; perhaps in two gestures.
std::vector<int> trace_table(Composer& composer, const Table& table);

/// Round the contours of screens, closed, one after the other in one gesture.
std::vector<int> trace_screens(Composer& composer, const std::vector<const Screen*>& screens);

}  // namespace kinemap::sim
