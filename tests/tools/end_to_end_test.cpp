// SPDX-License-Identifier: Apache-2.0
// The whole way, against the truth of a simulator that shares no code with the estimator: datagrams of a wearer in a
// building → map.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/kinemap/batch.hpp"
#include "tools/kinemap/evaluation.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;

class EndToEnd : public testing::Test {
 protected:
  EndToEnd() : dir_(fs::temp_directory_path() / ("kinemap-e2e-" + std::to_string(::getpid()))) {}
  ~EndToEnd() override { fs::remove_all(dir_); }

  eval::Evaluation run(std::uint64_t seed, sim::Severity drift) {
    sim::SimOptions options;
    options.seed = seed;
    options.drift = drift;
    options.out_dir = (dir_ / std::to_string(seed)).string();
    const auto session = sim::simulate_to_directory(options);
    EXPECT_TRUE(session) << session.error();
    const auto built = cli::build_map(session->session_path, Config{});
    EXPECT_TRUE(built) << built.error();
    std::ostringstream text;
    text << std::ifstream(session->truth_path).rdbuf();
    const auto truth = eval::truth_from_text(text.str());
    EXPECT_TRUE(truth) << truth.error();
    const auto evaluation = eval::evaluate(*built->map, *truth);
    EXPECT_TRUE(evaluation) << evaluation.error();
    return *evaluation;
  }

  eval::Report run_all(sim::Severity drift) {
    std::vector<eval::Evaluation> sessions;
    for (const std::uint64_t seed : {3, 4, 7, 9}) sessions.push_back(run(seed, drift));
    return eval::summarise(sessions);
  }

  static const eval::Report::PerClass& of(const eval::Report& report, eval::Class c) {
    return report.classes[static_cast<std::size_t>(c)];
  }

 private:
  fs::path dir_;
};

TEST_F(EndToEnd, WithLittleDriftEverythingIsFoundAndNothingElse) {
  const auto report = run_all(sim::Severity::Good);
  EXPECT_EQ(report.total.found, report.total.truth);
  EXPECT_EQ(report.total.estimated, report.total.found);
  // Below the paper's Table I by far, distractors and all.
  EXPECT_LT(of(report, eval::Class::Table).mape_percent.median, 5.0);
  EXPECT_LT(of(report, eval::Class::BigScreen).mape_percent.median, 4.0);
  EXPECT_LT(of(report, eval::Class::Wall).mape_percent.median, 2.0);
  EXPECT_LT(of(report, eval::Class::Chair).level_error_m.mean, 0.08);
}

TEST_F(EndToEnd, WithTheDriftOfAnOfficeTheTrajectoryIsCorrected) {
  const auto report = run_all(sim::Severity::Default);
  EXPECT_GE(eval::recall(report.total), 0.95);
  EXPECT_GE(eval::precision(report.total), 0.95);
  EXPECT_LT(of(report, eval::Class::Table).mape_percent.mean, 10.0);
  EXPECT_LT(of(report, eval::Class::Wall).mape_percent.median, 5.0);
  EXPECT_LT(report.rmse_optimised_m.mean, 0.5 * report.rmse_open_loop_m.mean);
  EXPECT_LT(report.rmse_optimised_m.max, report.rmse_open_loop_m.mean);
}

}  // namespace
}  // namespace kinemap
