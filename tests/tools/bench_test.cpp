// SPDX-License-Identifier: Apache-2.0
#include <expat.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "protocol/map_json.hpp"
#include "tools/bench/document.hpp"
#include "tools/bench/ideal.hpp"
#include "tools/bench/levers.hpp"
#include "tools/bench/worst_cases.hpp"

namespace kinemap::bench {
namespace {

namespace fs = std::filesystem;

/// A directory of one test, removed with it.
class BenchTest : public testing::Test {
 protected:
  BenchTest() : directory_(fs::temp_directory_path() / ("kinemap-bench-test-" + std::to_string(::getpid()))) {}
  ~BenchTest() override { fs::remove_all(directory_); }

  [[nodiscard]] RunOptions run_options(int jobs) const {
    return {.cache = (directory_ / "cache").string(), .keep = "", .jobs = jobs, .label = ""};
  }
  fs::path directory_;
};

std::string contents(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Two short sessions.
std::vector<sim::SimOptions> short_sessions() {
  sim::SimOptions base;
  base.rooms = 1;
  base.rounds = 1;
  return sessions_of({1, 2}, base);
}

TEST(Ideal, KnowsSizesAsWellAsTheSuitIs) {
  double suit_way[2] = {}, true_way[2] = {};
  std::size_t n = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    for (const auto drift : {sim::Severity::Good, sim::Severity::Bad}) {
      sim::SimOptions options;
      options.seed = seed;
      options.rounds = 2;
      options.drift = drift;
      const auto sizes = ideal_sizes(options);
      ASSERT_TRUE(sizes) << sizes.error();
      for (const IdealSize& size : *sizes) {
        suit_way[drift == sim::Severity::Bad] += size.suit_way_percent;
        true_way[drift == sim::Severity::Bad] += size.true_way_percent;
        n += drift == sim::Severity::Bad ? 1 : 0;
      }
    }
  }
  ASSERT_GE(n, 8u);
  EXPECT_LT(suit_way[0] / static_cast<double>(n), 2.5);
  EXPECT_LT(suit_way[1] / static_cast<double>(n), 15.0);
  EXPECT_GT(suit_way[1], 2.0 * suit_way[0]);
  EXPECT_LT(true_way[1], suit_way[1]);
}

TEST(Levers, EachChangesTheConfiguration) {
  for (const Lever& lever : levers()) {
    const auto config = without(Config{}, lever);
    ASSERT_TRUE(config) << lever.name << ": " << config.error();
    EXPECT_FALSE(changed_keys(Config{}, *config).empty()) << lever.name << " switches nothing off";
  }
}

TEST(Levers, KeepWhatElseIsConfigured) {
  Config config;
  config.mapper.walls.height_m = 3.25;
  for (const Lever& lever : levers()) EXPECT_EQ(without(config, lever)->mapper.walls.height_m, 3.25) << lever.name;
}

TEST(Sessions, AreNamedByAllThatTheyDependOn) {
  const sim::SimOptions plain;
  sim::SimOptions other = plain;
  other.sloppiness = 0.7;
  EXPECT_NE(session_name(plain), session_name(other));
  other = plain;
  other.closure_spacing_m = 30.0;
  EXPECT_NE(session_name(plain), session_name(other));
  other = plain;
  other.drift = sim::Severity::Bad;
  EXPECT_NE(session_name(plain), session_name(other));
}

TEST(Seeds, OfAList) {
  EXPECT_EQ(parse_seeds("1-3,7"), (std::vector<std::uint64_t>{1, 2, 3, 7}));
  for (const char* wrong : {"", "x", "3-1", "1-", "1-99999999999"}) EXPECT_FALSE(parse_seeds(wrong)) << wrong;
}

TEST_F(BenchTest, TheNumberOfJobsChangesNothing) {
  const auto one = run_sessions(short_sessions(), {Config{}}, run_options(1));
  const auto three = run_sessions(short_sessions(), {Config{}}, run_options(3));
  ASSERT_TRUE(one && three);
  ASSERT_EQ((*one)[0].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*three)[0][i].sim.seed, i + 1);
    EXPECT_EQ(map_text(*(*one)[0][i].map), map_text(*(*three)[0][i].map));
    EXPECT_EQ((*one)[0][i].evaluation.rmse_optimised_m, (*three)[0][i].evaluation.rmse_optimised_m);
  }
}

TEST_F(BenchTest, ABrokenSessionIsReportedByItsSeed) {
  auto sessions = short_sessions();
  sessions[1].rate_hz = -1.0;
  const auto result = run_sessions(sessions, {Config{}}, run_options(2));
  ASSERT_FALSE(result);
  EXPECT_TRUE(result.error().starts_with("seed 2: ")) << result.error();
}

TEST_F(BenchTest, TheDocumentHasItsPicturesAndNoOthers) {
  auto runs = run_sessions(short_sessions(), {Config{}}, run_options(0));
  ASSERT_TRUE(runs);
  Study study;
  study.columns.push_back({"default", (*runs)[0], {}});
  study.ablation.push_back({levers()[0], (*runs)[0]});
  study.sparse = (*runs)[0];
  study.sparse_spacing_m = 30.0;
  const fs::path pictures = directory_ / "accuracy";
  fs::create_directories(pictures);
  std::ofstream(pictures / "worst-of-last-time.svg") << "old";
  const std::string worst = case_name(worst_cases(study.columns, 1).at(0));
  std::ofstream(pictures / "notes.json") << "{\"" << worst << "\": \"Somebody left the door open.\"}";
  const auto error = write_document((directory_ / "accuracy.md").string(), study, "bench accuracy");
  ASSERT_FALSE(error) << error->message;

  const std::string text = contents(directory_ / "accuracy.md");
  EXPECT_NE(text.find("Somebody left the door open."), std::string::npos);
  const std::regex picture("\\(accuracy/([^)]*\\.svg)\\)");
  std::size_t named = 0, there = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), picture); it != std::sregex_iterator(); ++it, ++named) {
    const std::string svg = contents(pictures / (*it)[1].str());
    XML_Parser parser = XML_ParserCreate(nullptr);
    EXPECT_EQ(XML_Parse(parser, svg.data(), static_cast<int>(svg.size()), 1), XML_STATUS_OK) << (*it)[1];
    EXPECT_EQ(svg.find("nan"), std::string::npos) << (*it)[1];
    XML_ParserFree(parser);
  }
  for (const auto& entry : fs::directory_iterator(pictures)) there += entry.path().extension() == ".svg" ? 1 : 0;
  EXPECT_EQ(named, there);
  EXPECT_GE(named, 5U);
}

}  // namespace
}  // namespace kinemap::bench
