// SPDX-License-Identifier: Apache-2.0
// The real program: its arguments, exit codes and signals, and recordings played into it over real UDP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/mapper/mapper.hpp"
#include "core/tracker/tracker.hpp"
#include "daemon/config.hpp"
#include "protocol/map_json.hpp"
#include "protocol/recording.hpp"
#include "protocol/wire/pcap.hpp"
#include "tests/daemon/client.hpp"
#include "tests/daemon/process.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;
using test::eventually;
using test::HttpClient;
using test::Process;
using test::RunningDaemon;
using testing::HasSubstr;

/// A file of the test's own, removed with it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / ("kinemapd_test_" + std::to_string(::getpid()) + ".json")) {
    write(text);
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Json status_of(const RunningDaemon& daemon) { return HttpClient(daemon.api_port).get("/api/v1/status").json(); }

std::uint64_t frames_of(const RunningDaemon& daemon) {
  return status_of(daemon)["tracker"]["frames"].get<std::uint64_t>();
}

TEST(Kinemapd, SaysItsVersionAndHelp) {
  Process version(KINEMAPD, {"--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_THAT(version.output(), HasSubstr("kinemapd "));
  Process help(KINEMAPD, {"--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_THAT(help.output(), HasSubstr("--config FILE"));
  EXPECT_THAT(help.output(), HasSubstr("Exit codes"));
}

TEST(Kinemapd, ChecksAndPrintsTheConfiguration) {
  Process check(KINEMAPD, {"--config", KINEMAP_SOURCE_DIR "/config/default.json", "--check-config"});
  EXPECT_EQ(check.wait(), 0);
  Process print(KINEMAPD, {"--print-config", "--port", "1234"});
  EXPECT_EQ(print.wait(), 0);
  auto expected = Config{};
  expected.api.port = 1234;
  EXPECT_EQ(nlohmann::ordered_json::parse(print.output()), to_json(expected));
}

TEST(Kinemapd, AWrongConfigurationIsExitCode2) {
  const TemporaryFile file(R"({"tracker": {"gesture": {"elbow_rad": 2}}})");
  for (const bool check : {true, false}) {
    std::vector<std::string> arguments{"--config", file.path()};
    if (check) arguments.emplace_back("--check-config");
    Process process(KINEMAPD, arguments);
    EXPECT_EQ(process.wait(), 2);
    EXPECT_THAT(process.output(), HasSubstr(file.path() + ": tracker.gesture.elbow_rad: unknown key"));
  }
  Process missing(KINEMAPD, {"--config", "/nowhere.json"});
  EXPECT_EQ(missing.wait(), 2);
  Process argument(KINEMAPD, {"--prot", "1"});
  EXPECT_EQ(argument.wait(), 2);
  Process port(KINEMAPD, {"--port", "70000"});
  EXPECT_EQ(port.wait(), 2);
}

TEST(Kinemapd, ATakenPortIsExitCode3) {
  const RunningDaemon first;
  ASSERT_TRUE(first.ready) << first.process.output();
  Process api(KINEMAPD, {"--suit-port", "0", "--port", std::to_string(first.api_port)});
  EXPECT_EQ(api.wait(), 3);
  EXPECT_THAT(api.output(), HasSubstr("TCP port " + std::to_string(first.api_port)));
  EXPECT_THAT(api.output(), HasSubstr("api.port in the configuration or --port"));
  Process suit(KINEMAPD, {"--port", "0", "--suit-port", std::to_string(first.suit_port)});
  EXPECT_EQ(suit.wait(), 3);
  EXPECT_THAT(suit.output(), HasSubstr("UDP port " + std::to_string(first.suit_port)));
  EXPECT_THAT(suit.output(), HasSubstr("suit.port in the configuration or --suit-port"));
}

TEST(Kinemapd, SigtermAndSigintEndItWithinTwoSecondsWithWorkAndClients) {
  for (const int signal : {SIGTERM, SIGINT}) {
    RunningDaemon daemon;
    ASSERT_TRUE(daemon.ready) << daemon.process.output();
    test::UdpSender sender(daemon.suit_port);
    for (std::uint32_t i = 0; i < 600; ++i) sender.send(test::glider_datagram(i));
    HttpClient idle(daemon.api_port);
    test::StreamClient stream(daemon.api_port);
    stream.send(R"({"op":"subscribe","topics":["map","pose"]})");
    stream.receive();
    const auto begin = std::chrono::steady_clock::now();
    daemon.process.signal(signal);
    EXPECT_EQ(daemon.process.wait(), 0) << daemon.process.output();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  }
}

TEST(Kinemapd, SighupRereadsWhatCanBeReread) {
  const TemporaryFile file(R"({"log": {"level": "info"}})");
  RunningDaemon daemon({"--config", file.path()});
  ASSERT_TRUE(daemon.ready) << daemon.process.output();
  file.write(R"({"log": {"level": "debug"}, "tracker": {"key_poses": {"distance_m": 0.3}}})");
  daemon.process.signal(SIGHUP);
  EXPECT_TRUE(daemon.process.wait_for_output("log.level has changed"));
  EXPECT_TRUE(
      daemon.process.wait_for_output("tracker.key_poses.distance_m has changed in the file and needs a restart"));
  EXPECT_TRUE(daemon.process.wait_for_output("the configuration was read again"));
  file.write("{");
  daemon.process.signal(SIGHUP);
  EXPECT_TRUE(daemon.process.wait_for_output("the configuration stays as it was"));
  EXPECT_EQ(HttpClient(daemon.api_port).get("/healthz").status, 200);
  daemon.process.signal(SIGTERM);
  EXPECT_EQ(daemon.process.wait(), 0);
}

TEST(Kinemapd, ASuitBecomesATrajectoryAndItsGarbageACounter) {
  RunningDaemon daemon;
  ASSERT_TRUE(daemon.ready) << daemon.process.output();
  test::UdpSender sender(daemon.suit_port);
  sender.send(test::name_datagram("Ada"));
  for (std::uint32_t i = 0; i < 600; ++i) {
    sender.send(test::glider_datagram(i));
    if (i % 100 == 0) sender.send(std::vector<std::byte>(50, std::byte{'?'}));
  }
  ASSERT_TRUE(eventually([&] { return frames_of(daemon) == 600; })) << status_of(daemon).dump(2);
  const auto status = status_of(daemon);
  EXPECT_EQ(status["suit"]["stream"]["faults"]["bad_magic"], 6);
  EXPECT_EQ(status["suit"]["stream"]["datagrams"], 607);
  EXPECT_EQ(status["suit"]["wearer"]["name"], "Ada");
  EXPECT_NEAR(status["tracker"]["path_m"].get<double>(), 599 / 120.0, 0.1);
  EXPECT_EQ(status["rings"]["frames"]["dropped"], 0);
  EXPECT_NEAR(HttpClient(daemon.api_port).get("/api/v1/pose").json()["position"][0].get<double>(), 599 / 120.0, 0.01);
}

/// Every recording through Assembler, Tracker and Mapper in this process, and through the program: the same counts and
/// map.
class Recording : public testing::TestWithParam<const char*> {};

void play(const std::string& path, std::uint16_t port) {
  auto reader = PcapReader::open(path);
  ASSERT_TRUE(reader) << reader.error();
  test::UdpSender sender(port);
  std::size_t sent = 0;
  for (;;) {
    auto packet = reader->next();
    ASSERT_TRUE(packet) << packet.error();
    if (!*packet) return;
    sender.send((*packet)->payload);
    // The frame ring holds 1024 frames; a recording sent in one go must not overrun it on a busy machine.
    if (++sent % 64 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

TEST_P(Recording, GivesTheSameMapInProcessAndThroughTheDaemon) {
  const std::string path = std::string(KINEMAP_SHARED_DATA "/") + GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "SKIPPED: " << path << " is not there";
  Tracker tracker{TrackerConfig{}};
  Mapper mapper{MapperConfig{}};
  std::vector<Event> events;
  RecordingSink sink;
  sink.on_frame = [&](const SuitFrame& frame) { tracker.step(frame, events); };
  const auto summary = read_recording(path, {}, sink);
  ASSERT_TRUE(summary) << summary.error();
  ASSERT_GT(summary->stream.frames, 100U);
  tracker.finish(events);
  for (const auto& event : events) mapper.add(event);
  mapper.finish();

  RunningDaemon daemon;
  ASSERT_TRUE(daemon.ready) << daemon.process.output();
  play(path, daemon.suit_port);
  // All events, and then the silence that ends the recording.
  ASSERT_TRUE(eventually([&] { return status_of(daemon)["map"]["solver"]["messages"] == events.size() + 1; }))
      << status_of(daemon).dump(2);
  const auto status = status_of(daemon);
  const auto& stats = tracker.stats();
  EXPECT_EQ(status["suit"]["stream"]["frames"], summary->stream.frames);
  EXPECT_EQ(status["suit"]["stream"]["datagrams"], summary->stream.datagrams);
  EXPECT_EQ(status["suit"]["stream"]["lost_samples"], summary->stream.lost_samples);
  EXPECT_NEAR(status["suit"]["rate_hz"].get<double>(), summary->rate_hz, 1e-3);
  EXPECT_EQ(status["tracker"]["frames"], stats.frames);
  EXPECT_EQ(status["tracker"]["key_poses"], stats.key_poses);
  EXPECT_EQ(status["tracker"]["traces"], stats.traces);
  EXPECT_EQ(status["tracker"]["sittings"], stats.sittings);
  EXPECT_NEAR(status["tracker"]["path_m"].get<double>(), stats.path_m, 1e-3);
  EXPECT_EQ(status["rings"]["frames"]["dropped"], 0);

  // The same map to the last digit: the way through sockets and threads changes nothing. And nobody shows anything
  // there.
  HttpClient client(daemon.api_port);
  auto map = nlohmann::ordered_json::parse(client.get("/api/v1/map").body);
  EXPECT_EQ(map.erase("run"), 1U);  // no two runs of the daemon have the same
  EXPECT_EQ(map.dump(), to_json(*mapper.snapshot()).dump());
  EXPECT_EQ(client.get("/api/v1/trajectory").json()["poses"].size(), stats.key_poses);
  EXPECT_EQ(client.get("/api/v1/objects").json()["matched"], 0);
}

INSTANTIATE_TEST_SUITE_P(SharedData, Recording,
                         testing::Values("cmu_walk_2.pcap", "cmu_walk_3.pcap", "cmu_jump_1.pcap",
                                         "cmu_directtraffic_4.pcap"));

}  // namespace
}  // namespace kinemap
