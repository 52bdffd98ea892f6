// SPDX-License-Identifier: Apache-2.0
// Real people (CMU motion capture as MXTP, see the data's README). None of them makes the modelling gesture or sits.
#include <gtest/gtest.h>

#include <filesystem>

#include "protocol/recording.hpp"
#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

std::vector<SuitFrame> frames_of(const std::string& name) {
  std::vector<SuitFrame> frames;
  RecordingSink sink;
  sink.on_frame = [&](const SuitFrame& frame) { frames.push_back(frame); };
  sink.on_wearer = [](const WearerInfo&) {};
  const auto summary = read_recording(std::string(KINEMAP_SHARED_DATA) + "/" + name, {}, sink);
  EXPECT_TRUE(summary) << name;
  return frames;
}

bool absent(const std::string& name) { return !std::filesystem::exists(std::string(KINEMAP_SHARED_DATA) + "/" + name); }

class NoObject : public testing::TestWithParam<const char*> {};

TEST_P(NoObject, ComesOfIt) {
  if (absent(GetParam())) GTEST_SKIP() << "RECORDING ABSENT: " << GetParam();
  const auto frames = frames_of(GetParam());
  ASSERT_GT(frames.size(), 300u);
  for (const SuitFrame& frame : frames) EXPECT_FALSE(frame.discontinuity) << "no jump of a person is one of the suit";
  const Outcome outcome = track(frames);
  EXPECT_TRUE(outcome.traces.empty());
  EXPECT_TRUE(outcome.sittings.empty());
  EXPECT_EQ(outcome.stats.traces_rejected, 0u) << "not even the start of a gesture";
  EXPECT_GE(outcome.key_poses.size(), 2u);
  std::cout << GetParam() << ": " << frames.size() << " frames, " << outcome.key_poses.size() << " key poses, path "
            << outcome.stats.path_m << " m\n";
}

INSTANTIATE_TEST_SUITE_P(Recordings, NoObject,
                         testing::Values("cmu_walk_2.pcap", "cmu_walk_3.pcap", "cmu_directtraffic_4.pcap",
                                         "cmu_jump_1.pcap", "cmu_washwindow_1.pcap"));

class Walk : public testing::TestWithParam<const char*> {};

TEST_P(Walk, HasAPlausiblePath) {
  if (absent(GetParam())) GTEST_SKIP() << "RECORDING ABSENT: " << GetParam();
  const auto frames = frames_of(GetParam());
  ASSERT_GT(frames.size(), 300u);
  const Outcome outcome = track(frames);
  const double duration_s = frames.back().time_s - frames.front().time_s;
  const double direct_m = (frames.back()[Segment::Pelvis].p - frames.front()[Segment::Pelvis].p).head<2>().norm();
  EXPECT_GE(outcome.stats.path_m, direct_m - 0.02);
  EXPECT_LE(outcome.stats.path_m, 1.1 * direct_m) << "they walk straight ahead";
  EXPECT_GT(outcome.stats.path_m / duration_s, 0.5);
  EXPECT_LT(outcome.stats.path_m / duration_s, 2.0);
  std::size_t on_a_foot = 0;
  for (const KeyPose& key : outcome.key_poses) on_a_foot += key.p_pelvis_stance.has_value();
  EXPECT_GT(on_a_foot, outcome.key_poses.size() / 3);
}

INSTANTIATE_TEST_SUITE_P(Recordings, Walk, testing::Values("cmu_walk_2.pcap", "cmu_walk_3.pcap"));

}  // namespace
}  // namespace kinemap::test
