// SPDX-License-Identifier: Apache-2.0
// `kinemap sessions` on a directory of sessions.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "daemon/session_files.hpp"
#include "protocol/export/exports.hpp"
#include "tests/tools/run_command.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using std::string;

const string kOldFile = KINEMAP_SOURCE_DIR "/tests/data/journal-v1.kjr";
const string kId = "20261122T135207Z";

class Sessions : public ::testing::Test {
 protected:
  Sessions() : root_(fs::temp_directory_path() / ("kinemap-sessions-test-" + std::to_string(::getpid()))) {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~Sessions() override { fs::remove_all(root_); }

  Ran sessions(std::vector<string> arguments, const string& directory = "state") {
    arguments.insert(arguments.begin(), {KINEMAP_BIN, "sessions"});
    arguments.insert(arguments.end(), {"--directory", at(directory)});
    return run_command(arguments);
  }
  void expect_refusal(std::vector<string> arguments, int code, const string& named) {
    const Ran ran = sessions(std::move(arguments));
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_NE(ran.err.find(named), string::npos) << ran.err;
    EXPECT_EQ(ran.out, "");
  }
  Json listed(const string& directory = "state") {
    return Json::parse(sessions({"list", "--json"}, directory).out)["sessions"];
  }
  [[nodiscard]] string at(const string& name) const { return (root_ / name).string(); }
  static string slurp(const string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  void import() {
    const Ran ran = sessions({"import", kOldFile});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, "imported " + kId + "\n");
  }

  const fs::path root_;
};

TEST_F(Sessions, WhatIsImportedIsListedShownAndExported) {
  import();
  ASSERT_EQ(listed().size(), 1U);
  EXPECT_EQ(listed()[0]["id"], kId);
  EXPECT_EQ(listed()[0]["state"], "closed");
  const Ran table = sessions({"list"});
  EXPECT_NE(table.out.find("2026-11-22T13:52:07Z"), string::npos) << table.out;
  const Json shown = Json::parse(sessions({"show", kId, "--json"}).out);
  EXPECT_EQ(shown["traces"], 1);
  EXPECT_EQ(shown["sittings"], 2);
  EXPECT_EQ(shown["wearers"][0], "Simulated 5");
  EXPECT_EQ(shown["damage"]["places"], 0);

  const Ran exported = sessions({"export", kId, "--out", at("map"), "--journal", at("s.kjr"), "--json"});
  ASSERT_EQ(exported.code, 0) << exported.err;
  EXPECT_EQ(Json::parse(exported.out)["objects"], 3);
  for (const Export& file : exports()) EXPECT_TRUE(fs::exists(at("map") + "/" + file.name)) << file.name;
  ASSERT_EQ(sessions({"import", at("s.kjr")}, "other").code, 0);
  ASSERT_EQ(sessions({"export", kId, "--out", at("map2")}, "other").code, 0);
  EXPECT_EQ(slurp(at("map/map.json")), slurp(at("map2/map.json"))) << "a file carries the whole session";
}

TEST_F(Sessions, TheOneThatADaemonWritesIsNotDeleted) {
  import();
  const Ran other = sessions({"export", kId, "--journal", at("s.kjr")});
  ASSERT_EQ(other.code, 0) << other.err;
  {
    auto lock = SessionLock::take(at("state"));
    ASSERT_TRUE(lock && *lock);
    (*lock)->name(kId);
    EXPECT_EQ(listed()[0]["state"], "open");
    expect_refusal({"delete", kId}, 1, "is written by a running kinemapd");
    (*lock)->name("20270101T000000Z");
    EXPECT_EQ(listed()[0]["state"], "closed");
  }
  EXPECT_EQ(sessions({"delete", kId}).code, 0);
  EXPECT_TRUE(listed().empty());
}

TEST_F(Sessions, DamageIsToldAndTheRestExported) {
  import();
  const string path = at("state/sessions/" + kId + "/journal.kjr");
  string bytes = slurp(path);
  bytes[bytes.size() / 4] ^= 1;
  { std::ofstream(path, std::ios::binary) << bytes << "torn"; }
  const Json damage = Json::parse(sessions({"show", kId, "--json"}).out)["damage"];
  EXPECT_EQ(damage["places"], 1);
  EXPECT_EQ(damage["torn_bytes"], 4);
  const Ran exported = sessions({"export", kId, "--out", at("map")});
  EXPECT_EQ(exported.code, 0);
  EXPECT_NE(exported.err.find("damaged in 1 places"), string::npos) << exported.err;

  fs::create_directories(at("state/quarantine"));
  fs::copy_file(path, at("state/quarantine/" + kId + ".kjr"));
  ASSERT_EQ(listed().size(), 2U);
  EXPECT_EQ(listed()[1]["id"], "quarantine/" + kId);
  EXPECT_EQ(listed()[1]["state"], "quarantined");
  EXPECT_EQ(sessions({"delete", "quarantine/" + kId}).code, 0);
  EXPECT_EQ(listed().size(), 1U);
}

TEST_F(Sessions, OfANewerVersionIsListedAndLeftAlone) {
  fs::create_directories(at("state/sessions/20270101T000000Z"));
  { std::ofstream(at("state/sessions/20270101T000000Z/journal.kjr")) << "kinemap-journal 9\n"; }
  EXPECT_EQ(listed()[0]["state"], "unreadable");
  expect_refusal({"export", "20270101T000000Z", "--out", at("m")}, 1, "a newer version of Kinemap");
  expect_refusal({"import", at("state/sessions/20270101T000000Z/journal.kjr")}, 1, "a newer version of Kinemap");
}

TEST_F(Sessions, WhatIsWrongIsSaid) {
  expect_refusal({"list"}, 1, "--directory");
  import();
  expect_refusal({"import", kOldFile}, 1, "already");
  expect_refusal({"import", at("none.kjr")}, 1, "there is no such file");
  expect_refusal({"import", KINEMAP_SOURCE_DIR "/README.md"}, 1, "no journal of Kinemap");
  expect_refusal({"show", "../" + kId}, 1, "there is no session ../" + kId);
  expect_refusal({"delete", "20000101T000000Z"}, 1, "there is no session");
  expect_refusal({"dance"}, 2, "dance");
  expect_refusal({"show"}, 2, "give the ID");
  expect_refusal({"export", kId}, 2, "--out DIR");
  expect_refusal({"list", kId}, 2, "takes no ID");
  expect_refusal({"list", "--out", at("m")}, 2, "are for export");
}

}  // namespace
}  // namespace kinemap
