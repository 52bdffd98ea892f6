// SPDX-License-Identifier: Apache-2.0
#include "daemon/map_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "protocol/map_delta.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

Json parsed(const SharedText& text) { return Json::parse(*text); }

/// The sample map, changed somehow: things move, come and go.
MapSnapshot changed(MapSnapshot map, std::mt19937& random) {
  const auto chance = [&](double p) { return std::uniform_real_distribution(0.0, 1.0)(random) < p; };
  ++map.revision;
  map.time_s += 1.0;
  for (auto& object : map.objects)
    if (chance(0.3)) object.pose.p.x() += 0.01;
  if (chance(0.2) && !map.objects.empty()) map.objects.erase(map.objects.begin());
  if (chance(0.4)) {
    map.objects.push_back(sample_map().objects[3]);
    map.objects.back().id = static_cast<std::uint32_t>(100 + map.revision);
  }
  if (chance(0.2)) map.rooms.clear();
  if (chance(0.2)) map.rooms = sample_map().rooms;
  if (chance(0.2)) map.doorways.push_back(sample_map().doorways[0]);
  if (chance(0.2)) map.unresolved.clear();
  return map;
}

TEST(MapHistory, DeltasGiveTheWholeMapWhateverAClientMisses) {
  std::mt19937 random(7);
  MapHistory history("run");
  MapSnapshot map = sample_map();
  history.update(std::make_shared<const MapSnapshot>(map));
  std::vector<Json> clients(5, parsed(history.whole()));
  for (int i = 0; i < 200; ++i) {
    map = changed(map, random);
    if (std::uniform_int_distribution(0, 3)(random) == 0) continue;  // a revision that the history does not see
    history.update(std::make_shared<const MapSnapshot>(map));
    for (auto& client : clients) {
      if (std::uniform_int_distribution(0, 4)(random) < 2) continue;  // this one is busy
      ASSERT_FALSE(apply_map_message(parsed(history.since({client["revision"], "run"})), client));
      ASSERT_EQ(client, parsed(history.whole())) << "revision " << map.revision;
    }
  }
}

TEST(MapHistory, ADeltaHasOnlyWhatChanged) {
  MapHistory history("run");
  MapSnapshot map = sample_map();
  history.update(std::make_shared<const MapSnapshot>(map));
  ++map.revision;
  map.objects[1].observations = 9;
  map.objects.erase(map.objects.begin());
  map.rooms.clear();
  history.update(std::make_shared<const MapSnapshot>(map));
  const Json delta = parsed(history.since({42, ""}));
  EXPECT_EQ(delta["since"], 42);
  EXPECT_EQ(delta["revision"], 43);
  ASSERT_EQ(delta["objects"].size(), 1U);
  EXPECT_EQ(delta["objects"][0]["observations"], 9);
  EXPECT_EQ(delta["removed"], (Json{{"objects", {1}}, {"rooms", {1}}}));
  EXPECT_FALSE(delta.contains("doorways"));
  EXPECT_FALSE(delta.contains("unresolved"));
  EXPECT_EQ(parsed(history.since({43, "run"}))["objects"], Json::array());
  EXPECT_EQ(history.since({42, ""}), history.since({42, ""})) << "made once for all";
}

TEST(MapHistory, WhatItDoesNotKnowIsAnsweredWithTheWholeMap) {
  MapHistory history("run");
  MapSnapshot map = sample_map();
  history.update(std::make_shared<const MapSnapshot>(map));
  const auto note = [&](const KnownMap& known) {
    const Json json = parsed(history.since(known));
    EXPECT_FALSE(json.contains("since"));
    EXPECT_EQ(json["objects"].size(), map.objects.size());
    return json.value("note", "");
  };
  EXPECT_THAT(note({41, "run"}), HasSubstr("too old"));
  EXPECT_THAT(note({43, "run"}), HasSubstr("newer than the map"));
  EXPECT_THAT(note({42, "nur"}), HasSubstr("another run"));
  EXPECT_TRUE(parsed(history.since({42, "run"})).contains("since"));
}

TEST(MapDelta, IsRefusedOnAnotherMap) {
  MapHistory history("run");
  MapSnapshot map = sample_map();
  history.update(std::make_shared<const MapSnapshot>(map));
  Json client = parsed(history.whole());
  const Json before = client;
  map.revision += 2;
  history.update(std::make_shared<const MapSnapshot>(map));
  EXPECT_TRUE(apply_map_message(parsed(history.since({43, "run"})), client));
  Json delta = parsed(history.since({42, "run"}));
  delta["run"] = "other";
  EXPECT_TRUE(apply_map_message(delta, client));
  EXPECT_EQ(client, before);
  EXPECT_FALSE(apply_map_message(parsed(history.since({1, "run"})), client)) << "the whole map, with a note";
  EXPECT_EQ(client, parsed(history.whole()));
}

TEST(MapHistory, RemovalsAreRememberedWithinABound) {
  MapHistory history("run");
  MapSnapshot map;
  map.objects = {sample_map().objects[3]};
  for (std::uint32_t i = 0; i < MapHistory::kTombstones + 100; ++i) {
    map.revision = i;
    map.objects[0].id = i + 1;
    history.update(std::make_shared<const MapSnapshot>(map));
  }
  EXPECT_EQ(parsed(history.since({98, ""}))["note"].is_string(), true);
  const Json oldest = parsed(history.since({99, ""}));
  EXPECT_EQ(oldest["since"], 99);
  EXPECT_EQ(oldest["removed"]["objects"].size(), MapHistory::kTombstones);
}

}  // namespace
}  // namespace kinemap
