// SPDX-License-Identifier: Apache-2.0
#include "daemon/recorder.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "daemon/session_files.hpp"
#include "protocol/recording.hpp"
#include "protocol/wire/pcap.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using test::eventually;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr std::uint16_t kPort = 9763;

class Recording : public testing::Test {
 protected:
  Recording() : dir_(fs::temp_directory_path() / ("kinemap-recorder-" + std::to_string(::getpid()))) {
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    std::signal(SIGXFSZ, SIG_IGN);
  }
  ~Recording() override { fs::remove_all(dir_); }

  static bool always(const fs::path&) { return true; }
  static Recorder::Limits small_files() {
    Recorder::Limits limits;
    limits.max_file_bytes = 20'000;
    return limits;
  }
  static std::vector<UdpPacket> packets(const fs::path& folder) {
    std::vector<UdpPacket> all;
    for (const auto& path : recordings_in(folder)) {
      auto reader = PcapReader::open(path.string());
      EXPECT_TRUE(reader) << reader.error();
      for (auto packet = reader->next(); packet && *packet; packet = reader->next()) all.push_back(**packet);
    }
    return all;
  }
  static void offer(Recorder& recorder, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) recorder.offer(test::glider_datagram(i), "192.168.1.7:49152", kPort);
  }
  /// All that was offered is on the disk, or was given up.
  static bool settled(const Recorder& recorder, std::uint64_t offered) {
    const auto stats = recorder.stats();
    return stats.datagrams + stats.dropped == offered && stats.waiting_bytes == 0;
  }

  const fs::path dir_;
};

TEST_F(Recording, EveryDatagramIsThereInOrderOverSeveralFiles) {
  {
    Recorder recorder(small_files(), always);
    offer(recorder, 0, 30);  // before it is known whose they are
    recorder.begin(dir_ / "a");
    for (std::uint32_t i = 30; i < 120; i += 10) {
      offer(recorder, i, i + 10);
      ASSERT_TRUE(eventually([&] { return settled(recorder, i + 10); }));
    }
    EXPECT_GT(recorder.stats().files, 2U);
    EXPECT_TRUE(recorder.stats().healthy);
    EXPECT_EQ(recorder.stats().dropped, 0U);
  }
  const auto all = packets(dir_ / "a");
  ASSERT_THAT(all, SizeIs(120));
  for (std::uint32_t i = 0; i < 120; ++i) ASSERT_EQ(all[i].payload, test::glider_datagram(i)) << i;
  EXPECT_EQ(all.front().source, "192.168.1.7:49152");
  EXPECT_EQ(all.front().destination_port, kPort);
  EXPECT_EQ(recordings_in(dir_ / "a").front().filename(), "suit-0001.pcap");
  std::uint64_t frames = 0;
  const RecordingSink sink{[&](const SuitFrame&) { ++frames; }, {}};
  ASSERT_TRUE(read_recording((dir_ / "a").string(), {}, sink)) << "a directory is read as one recording";
  EXPECT_EQ(frames, 120U);
}

TEST_F(Recording, ARestartGoesOnWithTheNextFileAndAnotherSessionWithItsOwn) {
  for (int life = 0; life < 2; ++life) {
    Recorder recorder({}, always);
    recorder.begin(dir_ / "a");
    offer(recorder, 0, 5);
  }
  EXPECT_THAT(packets(dir_ / "a"), SizeIs(10));
  EXPECT_THAT(recordings_in(dir_ / "a"), ElementsAre(dir_ / "a/suit-0001.pcap", dir_ / "a/suit-0002.pcap"));
  Recorder recorder({}, always);
  recorder.begin(dir_ / "a");
  offer(recorder, 0, 5);
  ASSERT_TRUE(eventually([&] { return settled(recorder, 5); }));
  recorder.begin(dir_ / "b");
  offer(recorder, 5, 8);
  ASSERT_TRUE(eventually([&] { return settled(recorder, 8); }));
  EXPECT_THAT(packets(dir_ / "b"), SizeIs(3));
}

TEST_F(Recording, WhatIsNoMxtpIsNotRecorded) {
  Recorder recorder({}, always);
  recorder.begin(dir_ / "a");
  recorder.offer(std::as_bytes(std::span("GET / HTTP/1.1")), "1.2.3.4:5", kPort);
  offer(recorder, 0, 1);
  ASSERT_TRUE(eventually([&] { return settled(recorder, 1); }));
  EXPECT_THAT(packets(dir_ / "a"), SizeIs(1));
}

TEST_F(Recording, AFullDiskIsSaidAndWhatCannotWaitIsCounted) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  Recorder::Limits limits;
  limits.max_waiting_bytes = 30'000;
  Recorder recorder(limits, always);
  recorder.begin(dir_ / "a");
  offer(recorder, 0, 3);
  ASSERT_TRUE(eventually([&] { return settled(recorder, 3); }));
  const rlimit full{recorder.stats().bytes + 20, before.rlim_max};  // in the middle of the next packet
  setrlimit(RLIMIT_FSIZE, &full);
  for (std::uint32_t i = 3; i < 203; ++i) {
    offer(recorder, i, i + 1);
    ASSERT_TRUE(eventually([&] { return recorder.stats().datagrams + recorder.stats().dropped == i + 1; }));
  }
  EXPECT_FALSE(recorder.stats().healthy);
  EXPECT_GT(recorder.stats().dropped, 0U);
  EXPECT_LT(recorder.stats().waiting_bytes, 40'000U);
  setrlimit(RLIMIT_FSIZE, &before);
  offer(recorder, 203, 204);
  ASSERT_TRUE(eventually([&] { return settled(recorder, 204); }));
  EXPECT_TRUE(recorder.stats().healthy);
  EXPECT_EQ(packets(dir_ / "a").size(), recorder.stats().datagrams);
}

TEST_F(Recording, ABudgetThatIsUsedUpEndsTheRecordingAndIsSaid) {
  Recorder recorder(small_files(), [this](const fs::path& folder) { return recordings_in(folder).size() < 2; });
  recorder.begin(dir_ / "a");
  for (std::uint32_t i = 0; i < 200; ++i) {
    offer(recorder, i, i + 1);
    ASSERT_TRUE(eventually([&] { return settled(recorder, i + 1); }));
  }
  EXPECT_THAT(recordings_in(dir_ / "a"), SizeIs(2));
  EXPECT_FALSE(recorder.stats().healthy);
  EXPECT_EQ(packets(dir_ / "a").size(), recorder.stats().datagrams);
}

}  // namespace
}  // namespace kinemap
