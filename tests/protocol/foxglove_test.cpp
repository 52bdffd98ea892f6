// SPDX-License-Identifier: Apache-2.0
// What the messages say; that they fit Foxglove's own schemas is checked by tests/foxglove with Foxglove's own
// packages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/body.hpp"
#include "protocol/foxglove/floor.hpp"
#include "protocol/foxglove/messages.hpp"
#include "protocol/foxglove/scene.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap::foxglove {
namespace {

using nlohmann::json;

Pose pose_of(const json& transform) {
  const auto &t = transform["translation"], &r = transform["rotation"];
  return {Eigen::Vector3d(t["x"], t["y"], t["z"]), Eigen::Quaterniond(r["w"], r["x"], r["y"], r["z"])};
}

std::vector<std::string> ids_of(const json& list) {
  std::vector<std::string> ids;
  for (const auto& item : list) ids.push_back(item["id"]);
  return ids;
}

TEST(FoxgloveChannels, SchemasAreObjectsWithoutReferences) {
  for (const Channel channel : kChannels) {
    const std::string text = schema_text(channel);
    const json schema = json::parse(text);
    EXPECT_EQ(schema["type"], "object");
    EXPECT_EQ(schema["title"], schema_name(channel));
    EXPECT_EQ(text.find("$ref"), std::string::npos);
    EXPECT_EQ(topic(channel)[0], '/');
  }
}

TEST(FoxgloveMessages, TheChainOfTransformsLeadsToEachSegment) {
  std::array<Pose, kSegmentCount> body;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto d = static_cast<double>(i);
    body[i] = {{0.1 * d, 1.0, 0.05 * d},
               Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * d, Eigen::Vector3d(1, 2, 3).normalized()))};
  }
  const Pose T_map_odom = level_pose({1, 2, 0}, 0.3);
  const Message message = transforms(12.25, T_map_odom, body);
  EXPECT_EQ(message.time_ns, 12250000000U);
  std::map<std::string, Pose> T_map{{"map", {}}};
  const json parsed = json::parse(message.json);
  for (const auto& transform : parsed["transforms"]) {
    EXPECT_EQ(transform["timestamp"], json::parse(R"({"sec":12,"nsec":250000000})"));
    ASSERT_TRUE(T_map.contains(transform["parent_frame_id"])) << transform;
    T_map[transform["child_frame_id"]] = T_map[transform["parent_frame_id"]] * pose_of(transform);
  }
  ASSERT_EQ(T_map.size(), 2 + kSegmentCount);
  for (const auto& [frame, segment] :
       {std::pair("pelvis", Segment::Pelvis), std::pair("head", Segment::Head),
        std::pair("right_hand", Segment::RightHand), std::pair("left_toe", Segment::LeftToe)}) {
    const Pose expected = T_map_odom * body[static_cast<std::size_t>(segment)];
    EXPECT_LT((T_map[frame].p - expected.p).norm(), 1e-3) << frame;
    EXPECT_LT(T_map[frame].q.angularDistance(expected.q), 1e-3) << frame;
  }
}

TEST(FoxgloveMessages, ALongTrajectoryIsThinnedButKeepsItsEnds) {
  MapSnapshot map;
  for (KeyPoseId i = 0; i < 1001; ++i) map.trajectory.push_back({i, 0.1 * i, level_pose({0.1 * i, 0, 1}, 0), {}});
  EXPECT_EQ(json::parse(trajectory(map).json)["poses"].size(), 1001U);
  const json poses = json::parse(trajectory(map, 100).json)["poses"];
  EXPECT_LE(poses.size(), 101U);
  EXPECT_EQ(poses.front()["position"]["x"], 0.0);
  EXPECT_EQ(poses.back()["position"]["x"], 100.0);
  EXPECT_EQ(json::parse(trajectory({}).json)["poses"], json::array());
}

TEST(FoxgloveScene, EveryObjectRoomAndDoorwayIsAnEntity) {
  Scene scene;
  const auto update = scene.update(sample_map());
  ASSERT_TRUE(update);
  const json message = json::parse(update->json);
  EXPECT_EQ(message["deletions"], json::array());
  EXPECT_THAT(ids_of(message["entities"]),
              testing::ElementsAre("object/1", "object/2", "object/5", "object/7", "room/1", "doorways"));
  const json& wall = message["entities"][0];
  EXPECT_EQ(wall["triangles"][0]["points"].size(), 4U);
  EXPECT_EQ(wall["texts"][0]["text"], "wall 1, 3.00 × 2.50 m");
  EXPECT_EQ(wall["timestamp"], json::parse(R"({"sec":12,"nsec":500000000})"));
  EXPECT_THAT(wall["metadata"], testing::Contains(json::parse(R"({"key":"functions","value":"[\"bound\"]"})")));
  const json& table = message["entities"][1]["cubes"][0];
  EXPECT_DOUBLE_EQ(table["size"]["x"], 1.6);
  EXPECT_DOUBLE_EQ(table["size"]["y"], 0.8);
  EXPECT_DOUBLE_EQ(table["pose"]["position"]["z"], 0.725);  // its upper face is where the hand was
  EXPECT_EQ(message["entities"][3]["cubes"].size(), 2U);    // seat and back
}

TEST(FoxgloveScene, AnUpdateHoldsWhatChangedAndDeletesWhatHasGone) {
  Scene scene;
  MapSnapshot map = sample_map();
  scene.update(map);
  ++map.revision;
  EXPECT_FALSE(scene.update(map)) << "nothing to see has changed";
  map.objects.erase(map.objects.begin() + 1);
  map.objects.front().pose.p.x() += 0.01;
  map.objects.front().observations = 4;
  map.rooms.clear();
  map.time_s = 200.0;
  const auto update = scene.update(map);
  ASSERT_TRUE(update);
  const json message = json::parse(update->json);
  EXPECT_THAT(ids_of(message["entities"]), testing::ElementsAre("object/1"));
  EXPECT_THAT(ids_of(message["deletions"]), testing::ElementsAre("object/2", "room/1"));
  EXPECT_EQ(message["deletions"][0]["type"], 0);
  const json whole = json::parse(scene.whole().json);
  EXPECT_EQ(whole["deletions"][0]["type"], 1);
  EXPECT_THAT(ids_of(whole["entities"]), testing::UnorderedElementsAre("object/1", "object/5", "object/7", "doorways"));
}

TEST(FoxgloveFloor, WalkedCellsAreColouredAndTheRestIsTransparent) {
  const json grid = json::parse(floor(sample_map()).json);
  // x 0.5 to 1.25 m at y = 1 m, 0.3 m to each side
  EXPECT_EQ(grid["pose"]["position"], json::parse(R"({"x":0.2,"y":0.7,"z":0.0})"));
  EXPECT_EQ(grid["column_count"], 14);
  EXPECT_EQ(grid["row_stride"], 56);
  const std::string data = grid["data"];
  EXPECT_EQ(data.size() % 4, 0U);
  EXPECT_EQ(data.size() / 4 * 3 / 56, 6U);
  // The corner is farther away than 0.3 m; the cell beside it is not.
  EXPECT_EQ(data.substr(0, 10), "AAAAAE2vfJ");
  EXPECT_EQ(json::parse(floor({}).json)["data"], "");
}

}  // namespace
}  // namespace kinemap::foxglove
