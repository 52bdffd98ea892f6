// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/bench/study.hpp"

/// The pictures of docs/accuracy.md as SVG texts.
namespace kinemap::bench {

/// Edge errors by class: the paper's Table I beside each column.
std::string table_chart(const std::vector<Column>& columns);

/// The paper's figure 6: RMSE of each session's trajectory, open loop and optimised, one panel for each column.
std::string trajectory_chart(const std::vector<Column>& columns);

/// What becomes of errors when each lever is off: one panel for each class and one for the trajectory.
std::string ablation_chart(const Column& full, const std::vector<LeverRuns>& ablation);

/// Share of errors within one and two of the reported sigmas, by class and quantity.
std::string consistency_chart(const Column& column);

}  // namespace kinemap::bench
