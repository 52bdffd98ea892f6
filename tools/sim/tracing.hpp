// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/composer.hpp"

namespace kinemap::sim {

/// How much of a wall to touch: every free stretch, the longest one, or a part of that to touch again what is known.
enum class WallExtent : std::uint8_t { All, Longest, Brief };

/// Runs the right hand along a face of a wall, from one end to the other or between what stands there; one gesture for
/// each free stretch of at least 0.8 m. False when nothing could be touched.
bool trace_wall(Composer& composer, const WallFace& wall, bool wall_at_right, WallExtent extent);

/// Along two adjacent edges of a table top (from a far corner round the near one to the other far one), three, or the
/// whole contour.
bool trace_table(Composer& composer, const Table& table);

/// Round the contour of a screen, closed.
bool trace_screen(Composer& composer, const Screen& screen);

}  // namespace kinemap::sim
