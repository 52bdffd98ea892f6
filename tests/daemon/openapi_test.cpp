// SPDX-License-Identifier: Apache-2.0
// Real answers of every route and real messages of the stream, for check_openapi.py to hold against the OpenAPI
// document that the daemon serves.
#include <gtest/gtest.h>

#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "daemon/latest.hpp"
#include "daemon/server.hpp"
#include "tests/daemon/client.hpp"
#include "tests/daemon/support.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

struct World {
  Latest<MapSnapshot> map{std::make_shared<const MapSnapshot>()};
  LiveBody body;
  std::mutex notices_mutex;
  std::vector<Notice> notices;

  void happen(const std::vector<Notice>& what) {
    const std::lock_guard lock(notices_mutex);
    notices = what;
  }
};

const std::vector<Notice> kNotices{{Notice::Kind::Trace, 1.0, 2.0, 17, 0.0},
                                   {Notice::Kind::Sitting, 1.0, 2.0, 0, 0.45}};

Sources sources_of(World& world) {
  Sources sources;
  sources.map = [&] { return world.map.get(); };
  sources.body = [&] { return world.body; };
  sources.suit = [] {
    ReceiverState suit{
        {}, std::make_shared<const ReceiverNews>(ReceiverNews{"1.2.3.4:5", "no", {"Ada", {}, {}, 1.7}}), 10.0};
    suit.counts.last_frame_s = 9.5;
    suit.counts.rate_hz = 120.0;
    return suit;
  };
  sources.pipeline = [] {
    PipelineStats stats;
    stats.has_journal = true;
    return stats;
  };
  sources.take_notice = [&]() -> std::optional<Notice> {
    const std::lock_guard lock(world.notices_mutex);
    if (world.notices.empty()) return std::nullopt;
    const Notice notice = world.notices.back();
    world.notices.pop_back();
    return notice;
  };
  return sources;
}

void fill(World& world) {
  MapSnapshot map = sample_map();
  map.pelvis_covariance.emplace(Eigen::Matrix<double, 6, 6>::Identity());
  world.map.set(std::make_shared<const MapSnapshot>(map));
  world.body = test::body_at(1.5, {1, 2, 1});
  world.happen(kNotices);
}

/// What each route is asked, where asking it plainly says too little; {…} of a path must be here.
const std::vector<std::pair<std::string, std::vector<std::string>>> kQuestions{
    {"/api/v1/map", {"", "?since=42", "?since=7", "?since=42&run=other", "?since=x", "?run=1"}},
    {"/api/v1/objects",
     {"", "?near=1,2&limit=2", "?near=1,2,3&within=2", "?type=wall&sort=-size", "?room=1", "?room=9", "?colour=red"}},
    {"/api/v1/objects/{id}", {"1", "2", "5", "7", "99", "x"}},
    {"/api/v1/rooms/{id}", {"1", "2"}},
    {"/api/v1/trajectory", {"", "?every=1", "?since=1", "?until=-1"}},
    {"/api/v1/events", {"", "?since=1&limit=1", "?limit=0"}},
};

Json ask(test::HttpClient& client, const std::string& path, const std::string& question) {
  const auto open = path.find('{');
  const auto reply = client.get(path.substr(0, open) + question);
  EXPECT_NE(reply.status, 0) << path << question;
  return {{"path", path},
          {"question", question},
          {"status", reply.status},
          {"type", reply.header("Content-Type")},
          {"body", reply.json()}};
}

Json answers_of(std::uint16_t port, const Json& openapi) {
  test::HttpClient client(port);
  Json answers = Json::array();
  for (const auto& [path, item] : openapi["paths"].items()) {
    std::vector<std::string> questions{path.find('{') == std::string::npos ? "" : "none"};
    for (const auto& [asked, list] : kQuestions)
      if (asked == path) questions = list;
    for (const auto& question : questions) {
      Json answer = ask(client, path, question);
      if (answer["type"] == "application/json") answers.push_back(std::move(answer));
    }
  }
  return answers;
}

Json messages_of(std::uint16_t port, World& world) {
  test::StreamClient client(port);
  Json messages = Json::array();
  std::set<std::string> topics;
  client.send(R"({"op":"subscribe","topics":["map","pose","body","status","events"]})");
  client.send(R"({"op":"query","id":1,"path":"objects"})");
  client.send(R"({"op":"query","id":"a","path":"nothing"})");
  client.send("nonsense");
  while (topics.size() < 8) {
    world.happen(kNotices);  // again and again: only who has subscribed hears of it
    messages.push_back(Json(client.receive()));
    const Json& message = messages.back();
    if (message.contains("closed")) break;
    topics.insert(message.value("op", "") + message.value("topic", ""));
  }
  MapSnapshot next = *world.map.get();
  ++next.revision;
  next.objects.pop_back();
  world.map.set(std::make_shared<const MapSnapshot>(next));
  messages.push_back(Json(client.receive({{"topic", "map"}})));
  EXPECT_TRUE(messages.back()["data"].contains("since"));
  return messages;
}

TEST(OpenApi, AnswersAreWrittenForTheCheck) {
  World world, empty;
  fill(world);
  Json out;
  for (World* each : {&world, &empty}) {
    Config::Api config;
    config.port = 0;
    auto started = Server::open(config, sources_of(*each), Config::Suit{}, 9763);
    ASSERT_EQ(started.index(), 0U);
    const std::uint16_t port = std::get<0>(started)->port();
    out["openapi"] = test::HttpClient(port).get("/api/v1/openapi.json").json();
    ASSERT_TRUE(out["openapi"].contains("paths"));
    for (Json& answer : answers_of(port, out["openapi"])) out["answers"].push_back(std::move(answer));
    if (each == &world) out["messages"] = messages_of(port, world);
  }
  std::ofstream(KINEMAP_BINARY_DIR "/api_answers.json") << out.dump(1);
}

}  // namespace
}  // namespace kinemap
