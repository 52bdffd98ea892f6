// SPDX-License-Identifier: Apache-2.0
// `kinemap pair`, the daemon that it opened, and `kinemap` as it asks that daemon from elsewhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/daemon/process.hpp"
#include "tests/tools/run_command.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

std::string slurp(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class Pair : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  Ran pair(std::vector<std::string> options) const {
    options.insert(options.begin(), {KINEMAP_BIN, "pair", "--config", config_});
    return run_command(options);
  }
  Json paired(std::vector<std::string> options = {}) const {
    options.emplace_back("--json");
    const Ran ran = pair(options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return Json::parse(ran.out, nullptr, false);
  }

  fs::path folder_ = fs::temp_directory_path() / ("pair_test." + std::to_string(::getpid()));
  std::string config_ = folder_ / "kinemap" / "config.json";
};

TEST_F(Pair, WritesWhatOnlyTheOwnerMayReadAndAsksForTheSameAgain) {
  const Json first = paired();
  for (const char* name : {"kinemap.tokens", "kinemap.key", "kinemap.crt"}) {
    struct stat info {};
    ASSERT_EQ(::stat((folder_ / "kinemap" / name).c_str(), &info), 0) << name;
    EXPECT_EQ(info.st_mode & 07777U, 0600U) << name;
    EXPECT_THAT(slurp(folder_ / "kinemap" / name), HasSubstr("made by `kinemap pair`")) << "or purge leaves it";
  }
  EXPECT_EQ(first["token"].get<std::string>().size(), 32U);
  EXPECT_EQ(paired(), first);
  EXPECT_NE(paired({"--admin"})["token"], first["token"]);
  const Json renewed = paired({"--renew"});
  EXPECT_NE(renewed["token"], first["token"]);
  EXPECT_NE(renewed["fingerprint"], first["fingerprint"]);
  EXPECT_THAT(slurp(folder_ / "kinemap/kinemap.tokens"), Not(HasSubstr(first["token"])));
}

TEST_F(Pair, ShowsLinkFingerprintAndCode) {
  const Ran ran = pair({"--host", "wearable.local"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json same = paired({"--host", "wearable.local"});
  EXPECT_THAT(ran.out, HasSubstr("https://wearable.local:8765/#token=" + same["token"].get<std::string>() + "\n"));
  EXPECT_THAT(ran.out, HasSubstr(same["fingerprint"]));
  EXPECT_THAT(ran.out, HasSubstr("█▀▀▀▀▀█"));  // a corner of the code
}

TEST_F(Pair, OffTakesTheDropInAwayAndKeepsTheKeys) {
  const Json first = paired();
  EXPECT_TRUE(fs::exists(first["drop_in"].get<std::string>()));
  EXPECT_THAT(pair({"--off"}).out, HasSubstr("Remote access is switched off"));
  EXPECT_FALSE(fs::exists(first["drop_in"].get<std::string>()));
  EXPECT_THAT(pair({"--off"}).out, HasSubstr("off already"));
  EXPECT_EQ(paired()["token"], first["token"]);
}

TEST_F(Pair, WhatIsWrongIsSaid) {
  EXPECT_EQ(pair({"--address", "127.0.0.1"}).code, 2);
  EXPECT_EQ(pair({"--address", "here"}).code, 2);
  paired();
  ::chmod((folder_ / "kinemap/kinemap.tokens").c_str(), 0644);
  EXPECT_THAT(pair({}).err, HasSubstr("others may read"));
}

TEST_F(Pair, OpensTheDaemonToWhoHasTheTokenAndKnowsTheCertificate) {
  const Json with = paired({"--host", "127.0.0.1"});
  std::ofstream(config_) << R"({"api": {"auth": "always"}, "suit": {"address": "127.0.0.1"}})";
  test::RunningDaemon daemon({"--config", config_});
  ASSERT_TRUE(daemon.ready) << daemon.process.output();
  EXPECT_THAT(daemon.process.output(), HasSubstr("map at https://0.0.0.0:"));
  const std::string url = "https://127.0.0.1:" + std::to_string(daemon.api_port);
  const std::string token = with["token"], fingerprint = with["fingerprint"];
  const auto kinemap = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KINEMAP_BIN);
    return run_command(arguments);
  };
  const auto map = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"map", "--json", "--url", url});
    return kinemap(options);
  };
  EXPECT_EQ(map({"--token", token, "--fingerprint", fingerprint}).code, 0);
  EXPECT_EQ(map({"--token", token, "--ca", folder_ / "kinemap/kinemap.crt"}).code, 0);
  const Ran stream =
      run_command({"/usr/bin/env", "KINEMAP_URL=" + url, "KINEMAP_TOKEN=" + token, "KINEMAP_FINGERPRINT=" + fingerprint,
                   "timeout", "--signal=INT", "5", KINEMAP_BIN, "watch", "--json"});
  EXPECT_THAT(stream.out, HasSubstr("kinemap/map")) << stream.err;
  EXPECT_THAT(map({"--fingerprint", fingerprint}).err, HasSubstr("put its token into KINEMAP_TOKEN"));
  EXPECT_THAT(map({"--token", token}).err, HasSubstr("--fingerprint"));
  std::string wrong = fingerprint;
  wrong[0] = wrong[0] == '0' ? '1' : '0';
  EXPECT_THAT(map({"--token", token, "--fingerprint", wrong}).err, HasSubstr("its certificate is another one"));
  EXPECT_EQ(map({"--token", token, "--fingerprint", "12:34"}).code, 2);
  EXPECT_THAT(kinemap({"map", "--url", "http://192.0.2.1", "--token", token}).err, HasSubstr("not sent in the clear"));
  EXPECT_THAT(kinemap({"map", "--url", "http://127.0.0.1:" + std::to_string(daemon.api_port)}).err,
              HasSubstr("this port speaks TLS"));
  // Renewed and reloaded: the old ones are out, on the run.
  const Json renewed = paired({"--renew", "--host", "127.0.0.1"});
  daemon.process.signal(SIGHUP);
  ASSERT_TRUE(daemon.process.wait_for_output("the configuration was read again"));
  EXPECT_THAT(map({"--token", token, "--fingerprint", fingerprint}).err, HasSubstr("its certificate is another one"));
  EXPECT_EQ(map({"--token", renewed["token"], "--fingerprint", renewed["fingerprint"]}).code, 0);
  daemon.process.signal(SIGTERM);
  EXPECT_EQ(daemon.process.wait(), 0);
  EXPECT_THAT(daemon.process.output(), Not(HasSubstr(token)));
}

TEST_F(Pair, WithoutTokenAndCertificateTheDaemonDoesNotOpenItself) {
  fs::create_directories(folder_ / "kinemap");
  std::ofstream(config_) << R"({"api": {"address": "0.0.0.0"}})";
  test::Process daemon(KINEMAPD_BIN, {"--config", config_});
  EXPECT_EQ(daemon.wait(), 2);
  EXPECT_THAT(daemon.output(), HasSubstr("`kinemap pair`"));
  EXPECT_EQ(run_command({KINEMAPD_BIN, "--config", config_, "--check-config"}).code, 2);
  paired();
  EXPECT_EQ(run_command({KINEMAPD_BIN, "--config", config_, "--check-config"}).code, 0);
}

}  // namespace
}  // namespace kinemap
