// SPDX-License-Identifier: Apache-2.0
#include "protocol/map_json.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

std::string error_of(const Json& json) {
  const auto map = map_from_text(json.dump());
  return map ? "" : map.error();
}

TEST(MapJson, HoldsWhatTheMapHolds) {
  const Json json = to_json(sample_map());
  EXPECT_EQ(json["format"], "kinemap/map");
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["revision"], 42);
  EXPECT_EQ(json["frame"]["up"], "+z");
  const Json& wall = json["objects"][0];
  EXPECT_EQ(wall["type"], "wall");
  EXPECT_EQ(wall["size"], Json::array({3.0, 2.5}));
  EXPECT_EQ(wall["plane"]["offset"], -4.0);
  EXPECT_EQ(wall["height_assumed"], true);
  EXPECT_EQ(wall["ends"], Json::array({"corner", "open"}));
  EXPECT_EQ(wall["corners"].size(), 4U);
  EXPECT_EQ(json["rooms"][0]["polygon"].size(), 6U);
  EXPECT_EQ(json["unresolved"][0]["reason"], "neither closed nor long");
  EXPECT_EQ(json["hand"]["part"], "palm");
  EXPECT_EQ(json["hand"]["touch_point"], Json::array({0.0, -0.09, -0.02}));
  EXPECT_EQ(json["wearers"][0]["name"], "Anna");
  EXPECT_EQ(json["wearers"][0]["stature"], 1.68);
  EXPECT_EQ(json["wearers"][0]["hand"]["part"], "tips");
  EXPECT_EQ(json["wearers"][1], (Json{{"hand", json["hand"]}}));
}

TEST(MapJson, LeavesOutWhatIsUnknown) {
  const Json json = to_json(sample_map());
  const Json &wall = json["objects"][0], &table = json["objects"][1], &chair = json["objects"][3];
  EXPECT_EQ(wall["sigma"]["size"], Json::array({0.05})) << "the height's is unknown";
  EXPECT_EQ(table["sigma"]["size"], Json::array({0.03, 0.02}));
  EXPECT_FALSE(table.contains("height_assumed"));
  for (const char* key : {"plane", "corners", "size", "sigma"}) EXPECT_FALSE(chair.contains(key)) << key;
  for (const char* key : {"hand", "wearers"}) EXPECT_FALSE(to_json(MapSnapshot{}).contains(key)) << key;
  EXPECT_EQ(map_text(sample_map()).find("null"), std::string::npos);
}

TEST(MapJson, SameMapSameBytes) {
  MapSnapshot other = sample_map();
  for (MapObject& object : other.objects) object.pose.q.coeffs() *= -1.0;  // the same rotations
  other.objects[0].plane->normal.y() = -0.0;
  EXPECT_EQ(map_text(sample_map()), map_text(other));
  EXPECT_EQ(map_text(sample_map()).back(), '\n');
  EXPECT_NE(map_text(sample_map()).find("\"size\": [1.6, 0.8]"), std::string::npos);
}

TEST(MapJson, RoundTrip) {
  const std::string text = map_text(sample_map());
  const auto map = map_from_text(text);
  ASSERT_TRUE(map) << map.error();
  ASSERT_EQ(map->objects.size(), 4U);
  EXPECT_EQ(map->objects[3].type, ObjectType::Chair);
  EXPECT_FALSE(map->objects[3].size.has_value());
  EXPECT_NEAR(heading_of(map->objects[3].pose.q), 1.5707963, 1e-5);
  EXPECT_EQ(map->rooms[0].wall_ids, std::vector<std::uint32_t>{1});
  EXPECT_EQ(map->rooms[0].inferred_sides, (std::vector<std::size_t>{2, 3}));
  ASSERT_EQ(map->doorways.size(), 1U);
  EXPECT_EQ(map->doorways[0].position, Eigen::Vector2d(4.0, 1.2));
  EXPECT_EQ(map->doorways[0].heading_rad, 3.14);
  EXPECT_EQ(map->doorways[0].room_ids, std::vector<std::uint32_t>{1});
  EXPECT_EQ(map->graph.contacts, 120U);
  EXPECT_EQ(map_text(*map), text) << "what was read is written again byte for byte";
}

TEST(MapJson, EmptyMap) {
  const auto map = map_from_text(map_text(MapSnapshot{}));
  ASSERT_TRUE(map) << map.error();
  EXPECT_TRUE(map->objects.empty());
}

TEST(MapJson, ErrorsNameTheKeyPath) {
  struct Case {
    const char* pointer;
    Json value;
    const char* expected;
  };
  const Case cases[] = {
      {"/format", "geojson", "format: expected \"kinemap/map\", got \"geojson\""},
      {"/version", 2, "version: this program reads version 1"},
      {"/revision", -1, "revision: expected a whole number"},
      {"/objects/1/type", "sofa", "objects[1].type: unknown object type \"sofa\""},
      {"/objects/0/id", 4294967296, "objects[0].id: expected a whole number from 0 to 4294967295"},
      {"/objects/2/pose/position", Json::array({1, 2}), "objects[2].pose.position: expected an array of 3"},
      {"/objects/2/pose/orientation", Json::array({1, 1, 0, 0}),
       "objects[2].pose.orientation: expected a unit quaternion"},
      {"/objects/0/corners/3/0", "x", "objects[0].corners[3][0]: expected a number"},
      {"/objects/0/ends/1", "door", "objects[0].ends[1]: expected \"corner\", \"inferred\" or \"open\""},
      {"/objects/0/height_assumed", 1, "objects[0].height_assumed: expected true or false"},
      {"/rooms", Json::object(), "rooms: expected an array"},
      {"/hand/part", "elbow", "hand.part: expected \"tips\" or \"palm\", got \"elbow\""},
      {"/graph/contacts", nullptr, "graph.contacts: expected a whole number"},
  };
  for (const Case& c : cases) {
    Json json = to_json(sample_map());
    json[Json::json_pointer(c.pointer)] = c.value;
    EXPECT_EQ(error_of(json).substr(0, std::string(c.expected).size()), c.expected) << c.pointer;
  }
}

TEST(MapJson, EveryRequiredKeyIsMissed) {
  const Json whole = to_json(sample_map());
  for (const auto& [key, value] : whole.items()) {
    if (key == "frame") continue;                     // says the same in every map
    if (key == "doorways") continue;                  // files of older versions lack it
    if (key == "hand" || key == "wearers") continue;  // not always known
    Json json = whole;
    json.erase(key);
    EXPECT_EQ(error_of(json), key + ": missing");
  }
  Json older = whole;
  older.erase("doorways");
  EXPECT_TRUE(map_from_text(older.dump()));
  EXPECT_NE(error_of(Json::array()), "");
  EXPECT_NE(error_of(Json(3)), "");
}

TEST(MapJson, EveryTruncationIsRefused) {
  const std::string text = map_text(sample_map());
  for (std::size_t length = 0; length + 2 < text.size(); ++length)
    ASSERT_FALSE(map_from_text(text.substr(0, length))) << length;
  EXPECT_EQ(map_from_text("{\n\n  oops").error().substr(0, 16), "not JSON: line 3");
}

TEST(MapJson, TextThatIsNotUtf8DoesNotBreakTheWriter) {
  MapSnapshot map = sample_map();
  map.unresolved[0].reason = "\xFF\xFE";
  EXPECT_TRUE(map_from_text(map_text(map)));
}

/// Leaves a produced map for the schema check (ctest map_schema).
TEST(MapJson, WritesTheSampleForTheSchemaCheck) {
  std::ofstream(KINEMAP_BINARY_DIR "/sample_map.json") << map_text(sample_map());
  std::ofstream(KINEMAP_BINARY_DIR "/empty_map.json") << map_text(MapSnapshot{});
}

}  // namespace
}  // namespace kinemap
