// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// Largest rotation error of a between factor at the current poses, rad; 0 without any. Gauss-Newton from a start with
/// loops turned by more than about 45° (π/4) often ends in a wrong optimum: take chordal_start then.
[[nodiscard]] double largest_rotation_error(const Graph& graph);

/// Replaces the poses by the chordal relaxation of the between factors (Martinec and Pajdla, "Robust rotation and
/// translation estimation in multiview reconstruction", CVPR 2007; Carlone et al., "Initialization techniques for 3D
/// SLAM", ICRA 2015): rotations as free 3×3 matrices by linear least squares, brought back to SO(3), then positions by
/// linear least squares. Needs no start at all. In each connected part one pose keeps its value: that of its first
/// prior, else its first pose. Losses are left out. Only for graphs without landmarks, which would be left behind.
/// False, and `graph` untouched, when it is faulty, has landmarks with factors, or the systems cannot be solved.
[[nodiscard]] bool chordal_start(Graph& graph);

}  // namespace kinemap::graph
