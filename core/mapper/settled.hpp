// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/graph/marginals.hpp"

namespace kinemap {

/// In a session of hours the way of long ago is well known and moves no more: from how many key poses on the graph's
/// poses should stay free. It lies a quarter of an hour or more of steady work back, grows in steps, and only as far as
/// the way is known well: what no closure has tied down stays free however long ago it was. So the time that an
/// optimisation takes goes with the way not yet settled, not with the length of the day. A session of half an hour is
/// never touched.
std::size_t first_unsettled_pose(const graph::Graph& graph, const graph::Marginals& marginals);

}  // namespace kinemap
