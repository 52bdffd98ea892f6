// SPDX-License-Identifier: Apache-2.0
// The Foxglove side without sockets; tests/foxglove has Foxglove's own client.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "daemon/foxglove_feed.hpp"
#include "daemon/foxglove_protocol.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap::foxglove {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(FoxgloveProtocol, ChoosesAmongTheOfferedSubprotocols) {
  EXPECT_EQ(choose_subprotocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(choose_subprotocol("x, foxglove.websocket.v1 ,foxglove.sdk.v1"), "foxglove.websocket.v1");
  for (const char* offered : {"", ",", " ", "foxglove", "foxglove.sdk.v12", "Foxglove.sdk.v1"})
    EXPECT_FALSE(choose_subprotocol(offered)) << offered;
}

TEST(FoxgloveProtocol, BadTextSaysWhatIsAllowed) {
  const auto problem = [](const std::string& text) {
    const auto message = parse_text(text);
    return std::holds_alternative<BadMessage>(message) ? std::get<BadMessage>(message).message : "nothing";
  };
  for (const char* text : {"", "{", "7", "[]", "\xff"}) EXPECT_THAT(problem(text), HasSubstr("JSON object")) << text;
  for (const char* text : {"{}", R"({"op":1})", R"({"op":"advertise"})"}) EXPECT_THAT(problem(text), HasSubstr("op"));
  for (const char* text : {R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":{}})",
                           R"({"op":"subscribe","subscriptions":[1]})", R"({"op":"subscribe","subscriptions":[{}]})",
                           R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
                           R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"})
    EXPECT_THAT(problem(text), HasSubstr("needs \"subscriptions\"")) << text;
  EXPECT_THAT(problem(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":6}]})"), HasSubstr("no channel 6"));
  EXPECT_THAT(problem(R"({"op":"unsubscribe","subscriptionIds":[-1]})"), HasSubstr("needs \"subscriptionIds\""));
  EXPECT_THAT(problem(std::string(200000, '[')), HasSubstr("JSON object"));
}

TEST(FoxgloveProtocol, ServiceRequestsAreReadWithinTheirBounds) {
  const std::string request("\x02\x03\0\0\0\x07\0\0\0\x04\0\0\0json{}", 19);
  const auto message = parse_binary(request);
  ASSERT_TRUE(std::holds_alternative<ServiceCall>(message));
  const auto& call = std::get<ServiceCall>(message);
  EXPECT_EQ(call.service, 3U);
  EXPECT_EQ(call.call, 7U);
  EXPECT_EQ(call.encoding, "json");
  EXPECT_EQ(call.payload, "{}");
  for (std::size_t length = 0; length < 17; ++length)
    EXPECT_TRUE(std::holds_alternative<BadMessage>(parse_binary(request.substr(0, length)))) << length;
  EXPECT_EQ(service_response_head(call), std::string("\x03\x03\0\0\0\x07\0\0\0\x04\0\0\0json", 17));
  EXPECT_EQ(message_head(1, 0x0807060504030201), std::string("\x01\x01\0\0\0\1\2\3\4\5\6\7\x08", 13));
}

struct Viewer : Listener {
  [[nodiscard]] bool wants(Channel channel) const override { return wanted.contains(channel); }
  void wake(std::chrono::steady_clock::time_point) override { ++woken; }
  std::set<Channel> wanted;
  int woken = 0;
};

class FoxgloveFeed : public testing::Test {
 protected:
  void tick() { feed_.tick(now_ += std::chrono::milliseconds(40)); }
  void publish(MapSnapshot map) { map_ = std::make_shared<const MapSnapshot>(std::move(map)); }
  std::uint64_t version(Channel channel) { return feed_.newest(channel).version; }

  std::shared_ptr<const MapSnapshot> map_ = std::make_shared<const MapSnapshot>();
  LiveBody body_;
  Api api_{{[this] { return map_; }, [this] { return body_; }, [] { return ReceiverState{}; },
            [] { return PipelineStats{}; }, [] { return std::optional<Notice>{}; }},
           Config::Suit{},
           9763};
  Feed feed_{api_};
  std::shared_ptr<Viewer> viewer_ = std::make_shared<Viewer>();
  std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
};

TEST_F(FoxgloveFeed, MakesOnlyWhatSomebodyWants) {
  feed_.join(viewer_);
  publish(sample_map());
  tick();
  for (const Channel channel : kChannels) EXPECT_EQ(version(channel), 0U);
  viewer_->wanted = {Channel::Scene};
  tick();
  EXPECT_EQ(version(Channel::Scene), 1U);
  EXPECT_EQ(version(Channel::Trajectory), 0U);
  EXPECT_EQ(viewer_->woken, 2);
  viewer_->wanted = {};
  tick();
  EXPECT_EQ(feed_.newest(Channel::Scene).text, nullptr) << "it would be old when somebody comes again";
}

TEST_F(FoxgloveFeed, TheSceneIsWholeAtFirstThenWhatChanged) {
  feed_.join(viewer_);
  viewer_->wanted = {Channel::Scene};
  tick();
  EXPECT_EQ(json::parse(*feed_.scene_since(0))["deletions"][0]["type"], 1) << "the empty scene is a scene, too";
  MapSnapshot map = sample_map();
  publish(map);
  tick();
  EXPECT_EQ(json::parse(*feed_.scene_since(1))["entities"].size(), 6U);
  map.objects.pop_back();
  ++map.revision;
  publish(map);
  tick();
  const json change = json::parse(*feed_.scene_since(2));
  EXPECT_EQ(change["deletions"][0]["id"], "object/7");
  EXPECT_EQ(change["entities"], json::array());
  for (const std::uint64_t behind : {0U, 1U}) {
    const json whole = json::parse(*feed_.scene_since(behind));
    EXPECT_EQ(whole["deletions"][0]["type"], 1);
    EXPECT_EQ(whole["entities"].size(), 5U);
  }
  ++map.revision;  // to look at it is the same
  publish(map);
  tick();
  EXPECT_EQ(version(Channel::Scene), 3U);
}

TEST_F(FoxgloveFeed, TransformsComeAtABoundedRateAndOnlyWhenSomethingMoves) {
  feed_.join(viewer_);
  viewer_->wanted = {Channel::Transforms};
  tick();
  EXPECT_EQ(json::parse(*feed_.newest(Channel::Transforms).text)["transforms"].size(), 1U) << "map → odom, always";
  body_ = live_body_of(SuitFrame{}, 0.0);
  for (int ms = 1; ms <= 1000; ++ms) {
    body_.time_s = 1e-3 * ms;
    feed_.tick(now_ += std::chrono::milliseconds(1));
  }
  EXPECT_EQ(json::parse(*feed_.newest(Channel::Transforms).text)["transforms"].size(), 24U);
  EXPECT_GE(version(Channel::Transforms), 30U);
  EXPECT_LE(version(Channel::Transforms), 33U);
  const auto before = version(Channel::Transforms);
  tick();
  tick();
  EXPECT_LE(version(Channel::Transforms), before + 1);  // the last frame, and no more
}

TEST_F(FoxgloveFeed, TrajectoryAndFloorComeWithTheMapAtMostOnceASecond) {
  feed_.join(viewer_);
  viewer_->wanted = {Channel::Trajectory, Channel::Floor};
  MapSnapshot map = sample_map();
  for (int i = 0; i < 50; ++i) {  // 2 s
    ++map.revision;
    publish(map);
    tick();
  }
  EXPECT_LE(version(Channel::Trajectory), 3U);
  EXPECT_GE(version(Channel::Trajectory), 2U);
  EXPECT_EQ(version(Channel::Floor), version(Channel::Trajectory));
}

TEST_F(FoxgloveFeed, TheLogIsKeptForWhoComesLater) {
  publish(sample_map());
  api_.look(now_);
  tick();
  std::vector<std::string> log;
  for (const Newest* entry = feed_.log_after(0); entry != nullptr; entry = feed_.log_after(entry->version))
    log.push_back(json::parse(*entry->text)["message"]);
  EXPECT_THAT(log, testing::Contains("chair 7 found"));
}

TEST_F(FoxgloveFeed, ServicesAreTheQueries) {
  publish(sample_map());
  const json advertised = json::parse(feed_.services().advertise_text());
  std::map<std::string, std::uint32_t> ids;
  for (const auto& service : advertised["services"]) ids[service["name"]] = service["id"];
  for (const char* name : {"map", "objects", "objects/by_id", "trajectory", "pose", "status"})
    EXPECT_TRUE(ids.contains(std::string("/kinemap/") + name)) << name;
  const auto call = [&](const char* name, const char* request, const char* encoding = "json") {
    const Reply reply = feed_.services().call({ids[name], 1, encoding, request});
    return json::parse(*reply.body);
  };
  EXPECT_EQ(call("/kinemap/objects", R"({"type":"chair"})")["matched"], 1);
  EXPECT_EQ(call("/kinemap/objects", "")["matched"], 4);
  EXPECT_EQ(call("/kinemap/objects/by_id", R"({"id":7})")["type"], "chair");
  for (const char* request : {R"({"id":"7"})", R"({"id":-7})", "{}", "[]", "{", R"({"id":7,"x":1})"})
    EXPECT_TRUE(call("/kinemap/objects/by_id", request).contains("error")) << request;
  EXPECT_TRUE(call("/kinemap/objects", R"({"type":{}})").contains("error"));
  EXPECT_TRUE(call("/kinemap/map", "", "cdr").contains("error"));
  EXPECT_TRUE(call("/nothing", "").contains("error"));
}

}  // namespace
}  // namespace kinemap::foxglove
