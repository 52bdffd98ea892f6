// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/bench/accuracy.hpp"
#include "tools/bench/ideal.hpp"
#include "tools/bench/levers.hpp"

namespace kinemap::bench {

/// The paper's Table I: mean absolute percentage error of the edge lengths, mean and standard deviation.
struct PaperRow {
  eval::Class klass;
  std::size_t n;
  double mean, std;
};
inline constexpr PaperRow kPaper[] = {{eval::Class::Table, 36, 26.3, 8.7},
                                      {eval::Class::BigScreen, 9, 23.1, 2.7},
                                      {eval::Class::SmallScreen, 23, 19.3, 4.8},
                                      {eval::Class::Wall, 36, 7.1, 3.5}};

/// One column of the table of suit drift.
struct Column {
  std::string drift;
  std::vector<Session> sessions;
  std::vector<std::vector<IdealSize>> ideal;  ///< one list for each session
};

/// The same sessions with one lever off.
struct LeverRuns {
  Lever lever;
  std::vector<Session> sessions;
};

/// A column with a suit that does not hold standing feet in place.
struct SlippingFeet {
  std::string drift;
  std::vector<Session> heard, not_heard;
};

/// A recording in which nothing is drawn and nobody sits.
struct QuietRecording {
  std::string name;
  double duration_s = 0.0;
  std::size_t objects = 0;
};

struct StudyOptions {
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> drifts;
  sim::SimOptions sim;  ///< seed, drift and sloppiness are filled in
  Config config;
  bool ablation = false;          ///< of the default column, or of the first one
  bool slipping_feet = false;     ///< the same seeds once more, with a suit that does not hold standing feet in place
  double sparse_spacing_m = 0.0;  ///< > 0: the same seeds once more, with closures only so often
  std::string recordings;         ///< directory of recordings in which nothing is to be found; empty: none
  RunOptions run;
};

/// All that was run.
struct Study {
  std::vector<Column> columns;
  std::size_t ablated = 0;          ///< index of the column
  std::vector<LeverRuns> ablation;  ///< empty: not run
  std::vector<SlippingFeet> slipping;
  double sparse_spacing_m = 0.0;
  std::vector<Session> sparse;
  std::vector<QuietRecording> quiet;
};

/// Runs everything that is asked for. The first Error ends it.
Result<Study> run_study(const StudyOptions& options);

}  // namespace kinemap::bench
