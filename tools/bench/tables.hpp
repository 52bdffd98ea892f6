// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/bench/study.hpp"

/// The tables and sentences of docs/accuracy.md, as Markdown.
namespace kinemap::bench {

/// How many sessions of which rooms, wearers and habits.
std::string coverage_text(const Study& study);
/// Table I of the paper beside each column.
std::string paper_table(const std::vector<Column>& columns);
/// In how many sessions the optimised trajectory is the better one.
std::string better_text(const std::vector<Column>& columns);
/// One line for each session.
std::string session_table(const std::vector<Session>& sessions);
/// Walls as they are, those whose neighbours were touched, and these with the scale of the trajectory taken out.
std::string scale_table(const std::vector<Column>& columns);
/// Screens and tables that were drawn all round, beside what the best linear unbiased estimator makes of them.
std::string ideal_table(const std::vector<Column>& columns);
std::string ablation_table(const Column& full, const std::vector<LeverRuns>& ablation);
/// Feet heard and not, of each column.
std::string slipping_table(const std::vector<SlippingFeet>& slipping);
/// Is the map still right but for its measures?
std::string sparse_text(const std::vector<Session>& sessions);
/// Objects that came of gestures and recordings that mean nothing.
std::string nothing_text(const Study& study);

}  // namespace kinemap::bench
