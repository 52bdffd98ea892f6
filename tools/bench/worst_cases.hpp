// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/study.hpp"

namespace kinemap::bench {

/// One object that came out badly.
struct WorstCase {
  std::string drift;
  const Session* session = nullptr;
  const eval::Match* match = nullptr;
};

/// The `count` largest relative errors of edge lengths over all columns, at most one from each seed: what spoils one
/// wall spoils its neighbours too, in every column.
std::vector<WorstCase> worst_cases(std::span<const Column> columns, std::size_t count);

/// "default-seed7-wall5": names its picture and its note.
std::string case_name(const WorstCase& worst);

/// What the data say of it: sizes, visits, drift, closures; one paragraph of Markdown.
std::string explain(const WorstCase& worst);

}  // namespace kinemap::bench
