// SPDX-License-Identifier: Apache-2.0
#include "daemon/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "daemon/config_fields.hpp"

namespace kinemap {
namespace {

using testing::HasSubstr;

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::string error_of(const std::string& json) {
  const auto config = config_from_text(json, "test.json");
  return config ? "no error" : config.error();
}

struct Anything {
  template <class T>
  operator T() const;  // only its type is used
};

template <class T, class... Args>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Args{}..., Anything{}}; })
    return member_count<T, Args..., Anything>();
  else
    return sizeof...(Args);
}

/// Visitor: holds the number of members of each struct against the number of fields in its list.
struct Counter {
  std::string prefix;
  std::size_t fields_seen = 0;

  template <class T>
  void check(T& value) {
    fields(*this, value);
    EXPECT_EQ(fields_seen, member_count<T>()) << "members of the struct of " << (prefix.empty() ? "Config" : prefix)
                                              << " that daemon/config_fields.hpp does not list";
  }
  template <class T>
  void section(const char* key, T& value) {
    ++fields_seen;
    Counter inner{prefix + key + ".", 0};
    inner.check(value);
  }
  template <class T>
  void number(const char*, T&, const Range&) {
    ++fields_seen;
  }
  void flag(const char*, bool&) { ++fields_seen; }
  void choice(const char*, std::string&, std::initializer_list<const char*>) { ++fields_seen; }
  void address(const char*, std::string&) { ++fields_seen; }
  void path(const char*, std::string&) { ++fields_seen; }
  void list(const char*, std::vector<std::string>&, const ListOf&) { ++fields_seen; }
  void at_most(const char*, double, const char*, double) {}
};

TEST(Config, EveryMemberIsListed) {
  Config config;
  Counter counter{"", 0};
  counter.check(config);
}

TEST(Config, MemberCountCounts) {
  struct Inner {
    double a = 1, b = 2;
  };
  struct Outer {
    Inner inner;
    std::string text = "x";
    int number = 3;
  };
  EXPECT_EQ(member_count<Inner>(), 2U);
  EXPECT_EQ(member_count<Outer>(), 3U);
}

TEST(Config, DefaultFileIsTheDefaultsWithEveryKey) {
  const std::string path = KINEMAP_SOURCE_DIR "/config/default.json";
  const auto config = config_from_file(path);
  ASSERT_TRUE(config) << config.error();
  EXPECT_EQ(changed_keys(Config{}, *config), std::vector<std::string>{});
  // As texts of JSON: no key is missing in the file, and they stand in the same order.
  EXPECT_EQ(nlohmann::ordered_json::parse(text_of(path), nullptr, true, true).dump(2), to_json(Config{}).dump(2));
}

TEST(Config, DefaultsAreWithinTheirOwnRanges) {
  const auto config = config_from_text(to_json(Config{}).dump(), "defaults");
  ASSERT_TRUE(config) << config.error();
}

TEST(Config, EveryKeyIsReadAndPrinted) {
  // Each number is changed, read, and must come out changed: a line that reads into the wrong member is found.
  const auto flat = to_json(Config{}).flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number()) continue;
    auto changed = to_json(Config{});
    auto& place = changed[nlohmann::ordered_json::json_pointer(pointer)];
    if (value.is_number_float())
      place = value.get<double>() * 0.999;
    else
      place = value.get<std::int64_t>() + 1;
    const auto config = config_from_text(changed.dump(), "changed");
    ASSERT_TRUE(config) << config.error();
    std::string key = pointer.substr(1);
    std::replace(key.begin(), key.end(), '/', '.');
    if (value == 0.0) continue;  // 0 · 0.999 is no change
    EXPECT_EQ(changed_keys(Config{}, *config), std::vector<std::string>{key});
  }
}

TEST(Config, ReadmeHasEveryKeyWithUnitDefaultAndRange) {
  const std::string readme = text_of(KINEMAP_SOURCE_DIR "/config/README.md");
  for (const auto& key : config_keys()) {
    const std::string row =
        "| `" + key.path + "` | " + key.unit + " | " + key.default_value + " | " + key.allowed + " | ";
    EXPECT_THAT(readme, HasSubstr(row));
  }
}

TEST(Config, CommentsAndMissingKeysAreFine) {
  const auto config = config_from_text("{ // a comment\n \"log\": {\"level\": \"debug\"} /* another */ }", "x");
  ASSERT_TRUE(config) << config.error();
  EXPECT_EQ(changed_keys(Config{}, *config), std::vector<std::string>{"log.level"});
}

TEST(Config, UnknownKeyIsRefusedWithItsPathAndTheKeysThereAre) {
  const auto error = error_of(R"({"tracker": {"gesture": {"elbow_rad": 2}}})");
  EXPECT_THAT(error, HasSubstr("test.json: tracker.gesture.elbow_rad: unknown key"));
  EXPECT_THAT(error, HasSubstr("elbow_on_rad, elbow_off_rad"));
  EXPECT_THAT(error_of(R"({"sute": {}})"), HasSubstr("sute: unknown key; allowed here: suit, stream"));
}

TEST(Config, WrongTypesAreRefused) {
  EXPECT_THAT(error_of(R"({"tracker": {"key_poses": {"distance_m": "0.2"}}})"),
              HasSubstr("tracker.key_poses.distance_m: must be a number"));
  EXPECT_THAT(error_of(R"({"suit": {"port": 1.5}})"),
              HasSubstr("suit.port: must be a whole number, 0 to 65535, not 1.5"));
  EXPECT_THAT(error_of(R"({"suit": {"transport": "sctp"}})"),
              HasSubstr("suit.transport: must be one of \"udp\", \"tcp\", not \"sctp\""));
  EXPECT_THAT(error_of(R"({"suit": {"transport": 7}})"), HasSubstr("suit.transport: must be one of"));
  EXPECT_THAT(error_of(R"({"suit": {"address": "localhost"}})"),
              HasSubstr("suit.address: must be an IPv4 or IPv6 address"));
  EXPECT_THAT(error_of(R"({"journal": {"directory": "here"}})"),
              HasSubstr("journal.directory: must be an absolute path"));
  EXPECT_THAT(error_of(R"({"suit": {"allow": "10.0.0.1"}})"), HasSubstr("suit.allow: must be a list of addresses"));
  EXPECT_THAT(error_of(R"({"suit": {"allow": ["10.0.0.1/33"]}})"), HasSubstr("suit.allow: \"10.0.0.1/33\" is wrong"));
  EXPECT_THAT(error_of(R"({"api": {"allowed_hosts": ["a:1"]}})"), HasSubstr("api.allowed_hosts: \"a:1\" is wrong"));
  EXPECT_THAT(error_of(R"({"api": {"allowed_origins": ["https://a/b"]}})"), HasSubstr("api.allowed_origins: "));
  EXPECT_THAT(error_of(R"({"suit": 9763})"), HasSubstr("suit: must be an object"));
  EXPECT_THAT(error_of("[]"), HasSubstr("must be an object"));
  EXPECT_THAT(error_of(R"({"log": null})"), HasSubstr("log: must be an object"));
}

TEST(Config, RangesAreHeld) {
  EXPECT_THAT(error_of(R"({"suit": {"port": 65536}})"),
              HasSubstr("suit.port: 65536 is out of range: allowed are 0 to 65535"));
  EXPECT_THAT(error_of(R"({"suit": {"port": -1}})"), HasSubstr("suit.port: -1 is out of range"));
  EXPECT_THAT(error_of(R"({"api": {"pose_rate_hz": 0}})"),
              HasSubstr("api.pose_rate_hz: 0 is out of range: allowed are 0.1 to 240 Hz"));
  EXPECT_THAT(error_of(R"({"api": {"max_clients": 99999999999999999999}})"), HasSubstr("api.max_clients: "));
  EXPECT_TRUE(config_from_text(R"({"suit": {"port": 65535}})", "x"));
}

TEST(Config, HysteresisMustNotBeTurnedRound) {
  EXPECT_THAT(error_of(R"({"tracker": {"gesture": {"elbow_on_rad": 2.5, "elbow_off_rad": 2.4}}})"),
              HasSubstr("tracker.gesture.elbow_on_rad: 2.5 is more than elbow_off_rad (2.4)"));
}

TEST(Config, SyntaxErrorsNameLineAndColumn) {
  EXPECT_THAT(error_of("{\n  \"log\": {\n    \"level\" \"info\"\n  }\n}"),
              HasSubstr("test.json: parse error at line 3, column"));
  EXPECT_THAT(error_of(""), HasSubstr("test.json: parse error at line 1"));
  EXPECT_THAT(error_of("{\"api\": {\"pose_rate_hz\": 1e999}}"), HasSubstr("test.json: "));
}

TEST(Config, AKeyMayNotStandTwice) {
  EXPECT_THAT(error_of(R"({"log": {"level": "info", "level": "debug"}})"), HasSubstr("\"level\" stands twice"));
}

TEST(Config, ListsAreRead) {
  const auto config = config_from_text(
      R"({"suit": {"allow": ["10.0.0.0/8", "fe80::/10", "::1"]}, "api": {"allowed_origins": ["https://a.example:1"]}})",
      "x");
  ASSERT_TRUE(config) << config.error();
  EXPECT_EQ(changed_keys(Config{}, *config), (std::vector<std::string>{"suit.allow", "api.allowed_origins"}));
  EXPECT_EQ(config->suit.allow.size(), 3U);
}

TEST(Config, WhatLiesBesideTheFileIsLaidOverItByName) {
  const auto folder = std::filesystem::temp_directory_path() / ("config_test." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder / "conf.d");
  const auto write = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
  write("config.json", R"({"api": {"port": 1, "max_clients": 2}})");
  write("conf.d/20.json", R"({"api": {"port": 3}})");
  write("conf.d/10.json", R"({"api": {"port": 4, "pose_rate_hz": 5}})");
  write("conf.d/30.json~", "nonsense");
  const auto config = config_from_file(folder / "config.json");
  ASSERT_TRUE(config) << config.error();
  EXPECT_EQ(config->api.port, 3);
  EXPECT_EQ(config->api.max_clients, 2);
  EXPECT_EQ(config->api.pose_rate_hz, 5);
  write("conf.d/40.json", R"({"api": {"portt": 3}})");
  EXPECT_THAT(config_from_file(folder / "config.json").error(), HasSubstr("conf.d/40.json: api.portt: unknown key"));
  std::filesystem::remove_all(folder);
}

TEST(Config, AFileThatCannotBeReadIsNamed) {
  const auto config = config_from_file("/nowhere/kinemap.json");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error(), HasSubstr("/nowhere/kinemap.json"));
  EXPECT_FALSE(config_from_file("/"));
}

}  // namespace
}  // namespace kinemap
