// SPDX-License-Identifier: Apache-2.0
#include "daemon/live_events.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;
using Kinds = std::vector<std::string>;

/// The kinds of the events that came since the last time.
class Watcher {
 public:
  Kinds look(const MapSnapshot& map, bool tracing = false, bool receiving = false) {
    events.look({std::make_shared<const MapSnapshot>(map), 5.0, tracing, receiving});
    return fresh();
  }
  Kinds fresh() {
    Kinds kinds;
    for (const auto& event : events.all())
      if (event.number > seen_) kinds.push_back(event.kind);
    seen_ = events.newest();
    return kinds;
  }
  LiveEvents events;

 private:
  std::uint64_t seen_ = 0;
};

TEST(LiveEvents, ObjectsAreFoundChangedAndRemoved) {
  Watcher watcher;
  MapSnapshot map = sample_map();
  EXPECT_EQ(watcher.look({}), Kinds{});
  EXPECT_EQ(watcher.look(map),
            (Kinds{"object_found", "object_found", "object_found", "object_found", "loop_closed", "loop_revoked"}));
  EXPECT_EQ(watcher.look(map), Kinds{});
  map.objects[3].pose.p.x() += 0.015;
  EXPECT_EQ(watcher.look(map), Kinds{}) << "too little";
  map.objects[3].pose.p.x() += 0.015;
  EXPECT_EQ(watcher.look(map), Kinds{"object_changed"}) << "3 cm since it was announced";
  EXPECT_EQ(watcher.events.all().back().message, "chair 7 changed by 0.03 m");
  (*map.objects[0].size)[0] += 0.5;
  EXPECT_EQ(watcher.look(map), Kinds{"object_changed"});
  map.objects.pop_back();
  EXPECT_EQ(watcher.look(map), Kinds{"object_removed"});
  EXPECT_EQ(Json::parse(*watcher.events.all().back().data)["object"], 7);
}

TEST(LiveEvents, LoopsSayWhatWasSeenAgain) {
  Watcher watcher;
  MapSnapshot map = sample_map();
  watcher.look(map);
  ++map.objects[1].observations;
  EXPECT_EQ(watcher.look(map), Kinds{}) << "seen again, but nothing was closed";
  ++map.objects[1].observations;
  ++map.graph.loop_closures;
  EXPECT_EQ(watcher.look(map), Kinds{"loop_closed"});
  const Json loop = Json::parse(*watcher.events.all().back().data);
  EXPECT_EQ(loop["objects"], Json{2});
  EXPECT_EQ(loop["count"], 3);
  EXPECT_EQ(loop["time"], 5.0);
  ++map.graph.loop_closures_revoked;
  EXPECT_EQ(watcher.look(map), Kinds{"loop_revoked"});
}

TEST(LiveEvents, GesturesAndTheSuit) {
  Watcher watcher;
  const MapSnapshot map;
  EXPECT_EQ(watcher.look(map, false, true), Kinds{"suit_back"});
  EXPECT_EQ(watcher.look(map, true, true), Kinds{"gesture_began"});
  EXPECT_EQ(watcher.look(map, true, true), Kinds{});
  EXPECT_EQ(watcher.look(map, false, false), Kinds{"suit_lost"});
  watcher.events.add({Notice::Kind::Trace, 1.0, 2.0, 17, 0.0});
  watcher.events.add({Notice::Kind::Sitting, 1.0, 3.0, 0, 0.45});
  EXPECT_EQ(watcher.fresh(), (Kinds{"trace", "sitting"}));
  const Json sitting = Json::parse(*watcher.events.all().back().data);
  EXPECT_EQ(sitting["seat_height"], 0.45);
  EXPECT_EQ(sitting["number"], 5);
}

TEST(LiveEvents, OnlyTheNewestAreKept) {
  LiveEvents events;
  for (std::size_t i = 0; i < LiveEvents::kKept + 10; ++i) events.add({Notice::Kind::Trace, 1.0, 2.0, i, 0.0});
  EXPECT_EQ(events.all().size(), LiveEvents::kKept);
  EXPECT_EQ(events.all().front().number, 11U);
  EXPECT_EQ(events.newest(), LiveEvents::kKept + 10);
}

}  // namespace
}  // namespace kinemap
