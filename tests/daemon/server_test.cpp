// SPDX-License-Identifier: Apache-2.0
#include "daemon/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>

#include "daemon/latest.hpp"
#include "tests/daemon/client.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;
using test::eventually;
using test::HttpClient;
using test::StreamClient;
using testing::HasSubstr;

/// A server over values that a test sets, instead of over a pipeline.
class ServerTest : public testing::Test {
 protected:
  void start(Config::Api config = {}, ServerLimits limits = {}) {
    config.port = 0;
    Sources sources{[this] { return map_.get(); }, [this] { return body_.get(); },
                    [this] {
                      return ReceiverState{{}, refuse_ ? refused_ : news_, 10.0};
                    },
                    [] { return PipelineStats{}; }, [this] { return take_notice(); }};
    auto started = Server::open(config, std::move(sources), Config::Suit{}, 9763, limits);
    ASSERT_EQ(started.index(), 0U) << std::get<StartError>(started).message;
    server_ = std::move(std::get<0>(started));
    port_ = server_->port();
  }

  /// Publishes a map with so many chairs.
  void set_map(std::uint64_t revision, std::uint32_t chairs, double y = 0.0) {
    auto map = std::make_shared<MapSnapshot>();
    map->revision = revision;
    for (std::uint32_t id = 1; id <= chairs; ++id) {
      MapObject chair;
      chair.id = id;
      chair.type = ObjectType::Chair;
      chair.functions = {"sit"};
      chair.pose = level_pose({static_cast<double>(id), y, 0.45}, 0);
      map->objects.push_back(chair);
    }
    map_.set(std::move(map));
  }

  std::optional<Notice> take_notice() {
    const std::lock_guard lock(mutex_);
    if (notices_.empty()) return std::nullopt;
    const auto notice = notices_.back();
    notices_.pop_back();
    return notice;
  }

  Json status() { return HttpClient(port_).get("/api/v1/status").json(); }

  Latest<MapSnapshot> map_{std::make_shared<const MapSnapshot>()};
  LatestValue<LiveBody> body_;
  std::atomic<bool> refuse_{false};
  std::mutex mutex_;
  std::vector<Notice> notices_;
  std::shared_ptr<const ReceiverNews> news_ = std::make_shared<const ReceiverNews>();
  std::shared_ptr<const ReceiverNews> refused_ =
      std::make_shared<const ReceiverNews>(ReceiverNews{"", "choose another scenario", {}});
  std::unique_ptr<Server> server_;
  std::uint16_t port_ = 0;
};

TEST_F(ServerTest, EveryRouteAnswers) {
  start();
  set_map(3, 2);
  body_.set(test::body_at(1.5, {1, 2, 3}));
  HttpClient client(port_);  // one connection for all
  EXPECT_EQ(client.get("/api/v1/map").json()["revision"], 3);
  EXPECT_EQ(client.get("/api/v1/map").json()["format"], "kinemap/map");
  EXPECT_EQ(client.get("/api/v1/objects?type=chair&near=2,0&limit=1").json()["objects"][0]["id"], 2);
  EXPECT_EQ(client.get("/api/v1/objects/1").json()["type"], "chair");
  EXPECT_EQ(client.get("/api/v1/trajectory?since=0&until=9").json()["poses"], Json::array());
  EXPECT_EQ(client.get("/api/v1/pose").json()["position"], (Json{1, 2, 3}));
  const auto status = client.get("/api/v1/status").json();
  EXPECT_EQ(status["map"]["objects"]["chair"], 2);
  EXPECT_EQ(status["clients"]["connections"], 1);
  EXPECT_TRUE(status["suit"]["stream"]["faults"].contains("bad_magic"));
  EXPECT_GT(status["process"]["rss_bytes"], 0);
  const auto page = client.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.header("Content-Type"), HasSubstr("text/html"));
  EXPECT_THAT(page.body, HasSubstr("api/v1/map"));
  EXPECT_EQ(client.get("/api/v1/map").header("Content-Type"), "application/json");
  EXPECT_EQ(client.get("/api/v1/rooms").json()["rooms"], Json::array());
  const auto file = client.get("/api/v1/export/scene.glb");
  EXPECT_EQ(file.body.substr(0, 4), "glTF");
  EXPECT_EQ(file.header("Content-Type"), "model/gltf-binary");
  EXPECT_EQ(file.header("Content-Disposition"), "attachment; filename=\"scene.glb\"");
}

TEST_F(ServerTest, HealthSaysWaitingRefusedOrOk) {
  start();
  HttpClient client(port_);
  EXPECT_EQ(client.get("/healthz").status, 200);
  EXPECT_EQ(client.get("/healthz").json()["status"], "waiting");
  EXPECT_THAT(client.get("/healthz").json()["message"].get<std::string>(), HasSubstr("UDP 0.0.0.0:9763"));
  refuse_ = true;
  EXPECT_EQ(client.get("/healthz").json()["status"], "refused");
  EXPECT_EQ(client.get("/healthz").json()["message"], "choose another scenario");
}

TEST_F(ServerTest, HeadIsGetWithoutABody) {
  start();
  HttpClient client(port_);
  const auto head = client.request("HEAD", "/api/v1/map");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(head.header("Content-Length"), std::to_string(client.get("/api/v1/map").body.size()));
}

TEST_F(ServerTest, ErrorsAreJsonWithTheRightStatus) {
  start();
  set_map(1, 2);
  HttpClient client(port_);
  const auto expect = [&](const std::string& method, const std::string& target, int status, const std::string& code) {
    const auto reply = client.request(method, target);
    EXPECT_EQ(reply.status, status) << target;
    EXPECT_EQ(reply.json()["error"]["code"], code) << target;
    EXPECT_FALSE(reply.json()["error"]["message"].get<std::string>().empty());
    return reply;
  };
  expect("GET", "/nothing", 404, "not_found");
  EXPECT_EQ(expect("GET", "/api/v1/objcts", 404, "not_found").json()["error"]["nearest"], "/api/v1/objects");
  expect("GET", "/api/v1/nothing", 404, "not_found");
  expect("GET", "/api/v1/objects/99", 404, "not_found");
  expect("GET", "/api/v1/objects/x", 400, "bad_parameter");
  expect("GET", "/api/v1/objects?near=1", 400, "bad_parameter");
  expect("GET", "/api/v1/map?x=1", 400, "bad_parameter");
  expect("GET", "/api/v1/status?x=1", 400, "bad_parameter");
  expect("GET", "/api/v1/objects/1?x=1", 400, "bad_parameter");
  expect("GET", "/%zz", 400, "bad_target");
  expect("GET", "/api/v1/pose", 503, "no_suit");
  expect("GET", "/api/v1/stream", 426, "upgrade_required");
  expect("GET", "/" + std::string(3000, 'a'), 414, "target_too_long");
  expect("POST", "/api/v1/mop", 404, "not_found");
  EXPECT_EQ(expect("DELETE", "/api/v1/map", 405, "method_not_allowed").header("Allow"), "GET, HEAD");
  EXPECT_GE(status()["clients"]["errors"], 13);
}

TEST_F(ServerTest, WhatAClientHasIsNotSentAgain) {
  start();
  set_map(1, 100);
  HttpClient client(port_);
  const auto plain = client.get("/api/v1/map");
  const std::string tag = plain.header("ETag");
  EXPECT_EQ(plain.header("Vary"), "Accept-Encoding");
  EXPECT_EQ(plain.header("Cache-Control"), "no-cache");
  const auto ask = [&](std::vector<std::pair<std::string, std::string>> headers) {
    return client.request("GET", "/api/v1/map", headers);
  };
  const auto again = ask({{"If-None-Match", "\"other\", " + tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  EXPECT_EQ(again.header("ETag"), tag);
  const auto packed = ask({{"Accept-Encoding", "br, gzip"}, {"If-None-Match", tag}});
  EXPECT_EQ(packed.status, 200) << "other bytes, another strong tag";
  EXPECT_EQ(packed.header("Content-Encoding"), "gzip");
  EXPECT_LT(packed.body.size(), plain.body.size() / 4);
  EXPECT_EQ(ask({{"Accept-Encoding", "gzip"}, {"If-None-Match", packed.header("ETag")}}).status, 304);
  const auto head = client.request("HEAD", "/api/v1/map", {{"Accept-Encoding", "gzip"}});
  EXPECT_EQ(head.header("Content-Length"), std::to_string(packed.body.size()));
  set_map(2, 100);
  EXPECT_EQ(ask({{"If-None-Match", tag}}).status, 200);
  EXPECT_EQ(client.get("/api/v1/nothing").header("ETag"), "");
}

TEST_F(ServerTest, RequestsBeyondTheLimitsAreRefusedAndClosed) {
  start();
  const auto long_header =
      test::raw_exchange(port_, "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20000, 'x') + "\r\n\r\n");
  EXPECT_THAT(long_header, HasSubstr("HTTP/1.1 431 "));
  const auto long_body =
      test::raw_exchange(port_, "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n");
  EXPECT_THAT(long_body, HasSubstr("HTTP/1.1 413 "));
  EXPECT_THAT(test::raw_exchange(port_, "this is no HTTP\r\n\r\n"), HasSubstr("HTTP/1.1 400 "));
  EXPECT_EQ(test::raw_exchange(port_, ""), "");
  EXPECT_EQ(test::raw_exchange(port_, "GET / HTT"), "");
  EXPECT_EQ(HttpClient(port_).get("/healthz").status, 200);
}

TEST_F(ServerTest, OtherHostNamesAndOriginsAreRefused) {
  start();
  EXPECT_EQ(HttpClient(port_).request("GET", "/api/v1/map", {{"Host", "evil.example"}}).status, 403);
  const std::vector<std::pair<std::string, std::string>> upgrade{{"Connection", "Upgrade"},
                                                                 {"Upgrade", "websocket"},
                                                                 {"Sec-WebSocket-Version", "13"},
                                                                 {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="}};
  auto foreign = upgrade;
  foreign.emplace_back("Origin", "http://evil.example");
  const auto reply = HttpClient(port_).request("GET", "/api/v1/stream", foreign);
  EXPECT_EQ(reply.status, 403);
  EXPECT_EQ(reply.json()["error"]["code"], "forbidden_origin");
  EXPECT_EQ(HttpClient(port_).request("GET", "/elsewhere", upgrade).status, 404);
  EXPECT_EQ(HttpClient(port_).request("GET", "/", upgrade).json()["error"]["code"], "bad_subprotocol");
  auto viewer = upgrade;
  viewer.emplace_back("Sec-WebSocket-Protocol", "foxglove.sdk.v1");
  const auto accepted = HttpClient(port_).request("GET", "/", viewer);
  EXPECT_EQ(accepted.status, 101);
  EXPECT_EQ(accepted.header("Sec-WebSocket-Protocol"), "foxglove.sdk.v1");
  viewer.emplace_back("Origin", "http://evil.example");
  EXPECT_EQ(HttpClient(port_).request("GET", "/", viewer).status, 403);
  EXPECT_EQ(HttpClient(port_).request("GET", "/api/v1/stream", upgrade).status, 101);
}

TEST_F(ServerTest, BeyondMaxClientsTheAnswerIs503) {
  Config::Api config;
  config.max_clients = 2;
  start(config);
  StreamClient first(port_);
  auto second = std::make_unique<StreamClient>(port_);
  const auto refused = HttpClient(port_).get("/healthz");
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(refused.json()["error"]["code"], "too_many_clients");
  second.reset();
  EXPECT_TRUE(eventually([&] { return HttpClient(port_).get("/healthz").status == 200; }));
  // A limit that SIGHUP raised is in force.
  config.max_clients = 10;
  server_->reconfigure(config);
  HttpClient third(port_), fourth(port_);
  EXPECT_TRUE(eventually([&] { return third.get("/healthz").status == 200; }));
  EXPECT_EQ(fourth.get("/healthz").status, 200);
}

TEST_F(ServerTest, ATakenPortSaysWhichAndWhatToDo) {
  start();
  Config::Api config;
  config.port = port_;
  auto second = Server::open(config, {}, {}, 0);
  ASSERT_EQ(second.index(), 1U);
  EXPECT_EQ(std::get<StartError>(second).code, ExitCode::PortTaken);
  EXPECT_THAT(std::get<StartError>(second).message, HasSubstr("api.port in the configuration or --port"));
}

TEST_F(ServerTest, AStreamPushesMapsPosesStatusAndEvents) {
  start();
  set_map(1, 1);
  StreamClient client(port_);
  client.send(R"({"op":"subscribe","topics":["map","pose","status","events"]})");
  EXPECT_EQ(client.receive()["topics"], (Json{"map", "pose", "status", "events"}));
  // The state as it is comes without a change.
  EXPECT_EQ(client.receive({{"topic", "map"}})["data"]["revision"], 1);
  EXPECT_TRUE(client.receive({{"topic", "status"}})["data"].contains("rings"));
  set_map(2, 3);
  const auto delta = client.receive({{"topic", "map"}})["data"];
  EXPECT_EQ(delta["since"], 1);
  EXPECT_EQ(delta["objects"].size(), 2U);  // the two that are new
  body_.set(test::body_at(1.0, {4, 5, 6}));
  EXPECT_EQ(client.receive({{"topic", "pose"}})["data"]["position"], (Json{4, 5, 6}));
  body_.set(test::body_at(1.1, {5, 5, 6}));
  EXPECT_EQ(client.receive({{"topic", "pose"}})["data"]["time"], 1.1);
  {
    const std::lock_guard lock(mutex_);
    notices_.push_back({Notice::Kind::Trace, 1.0, 2.0, 17, 0.0});
  }
  Json event;
  do event = client.receive({{"topic", "events"}})["data"];
  while (event["event"] != "trace");
  EXPECT_EQ(event["contacts"], 17);
}

TEST_F(ServerTest, AClientThatHasAMapGetsOnlyWhatIsNew) {
  start();
  set_map(1, 3);
  HttpClient http(port_);
  const auto whole = http.get("/api/v1/map").json();
  const std::string run = whole["run"];
  set_map(2, 4);
  const auto delta = http.get("/api/v1/map?since=1&run=" + run).json();
  EXPECT_EQ(delta["since"], 1);
  EXPECT_EQ(delta["objects"].size(), 1U);
  const auto other = http.get("/api/v1/map?since=1&run=0").json();
  EXPECT_FALSE(other.contains("since"));
  EXPECT_THAT(other["note"].get<std::string>(), HasSubstr("another run"));
  EXPECT_EQ(http.get("/api/v1/map?run=0").json()["error"]["parameter"], "run");
  StreamClient stream(port_);
  stream.send(Json{{"op", "subscribe"}, {"topics", {"map"}}, {"since", 1}, {"run", run}}.dump());
  const auto message = stream.receive({{"topic", "map"}})["data"];
  EXPECT_EQ(message, delta);
  set_map(3, 2);
  EXPECT_EQ(stream.receive({{"topic", "map"}})["data"]["removed"]["objects"], (Json{3, 4}));
}

TEST_F(ServerTest, PosesAndBodiesComeAtTheChosenRate) {
  start();
  StreamClient client(port_);
  client.send(R"({"op":"subscribe","topics":["pose","body"],"rate_hz":100})");
  EXPECT_EQ(client.receive()["rate_hz"], (Json{{"pose", 100}, {"body", 100}}));
  body_.set(test::body_at(1.0, {4, 5, 6}));
  EXPECT_EQ(client.receive({{"topic", "body"}})["data"]["segments"][0], (Json{4, 5, 6, 1, 0, 0, 0}));
  client.send(R"({"op":"subscribe","topics":["pose"],"rate_hz":0.1})");
  EXPECT_EQ(client.receive({{"op", "subscribed"}})["rate_hz"], (Json{{"pose", 0.1}, {"body", 100}}));
  // Of a hundred frames within less than ten seconds all bodies come, but at most the pose that was due.
  int poses = 0;
  for (int i = 1; i <= 100; ++i) {
    body_.set(test::body_at(1.0 + i, {4, 5, 6}));
    Json message;
    do poses += (message = client.receive())["topic"] == "pose";
    while (message["topic"] != "body" || message["data"]["time"] != 1.0 + i);
  }
  EXPECT_LE(poses, 2);
}

TEST_F(ServerTest, EventsAreToldAndKept) {
  start();
  StreamClient client(port_);
  client.send(R"({"op":"subscribe","topics":["events"]})");
  client.receive();
  set_map(1, 2);
  EXPECT_EQ(client.receive()["data"]["message"], "chair 1 found");
  EXPECT_EQ(client.receive()["data"]["object"], 2);
  set_map(2, 1);
  EXPECT_EQ(client.receive()["data"]["event"], "object_removed");
  HttpClient http(port_);
  EXPECT_EQ(http.get("/api/v1/events").json()["events"].size(), 3U);
  EXPECT_EQ(http.get("/api/v1/events?limit=1").json()["events"][0]["message"], "chair 2 removed");
  EXPECT_EQ(http.get("/api/v1/events?since=3").json(), (Json{{"newest", 3}, {"events", Json::array()}}));
}

TEST_F(ServerTest, ALateSubscriberGetsTheStateAtOnce) {
  start();
  set_map(7, 1);
  body_.set(test::body_at(1.0, {4, 5, 6}));
  StreamClient early(port_), late(port_);
  early.send(R"({"op":"subscribe","topics":["map","pose"]})");
  early.receive({{"topic", "pose"}});
  late.send(R"({"op":"subscribe","topics":["map","pose"]})");
  EXPECT_EQ(late.receive({{"topic", "map"}})["data"]["revision"], 7);
  EXPECT_EQ(late.receive({{"topic", "pose"}})["data"]["time"], 1.0);
}

TEST_F(ServerTest, UnsubscribedTopicsAreNotPushed) {
  start();
  StreamClient client(port_);
  client.send(R"({"op":"subscribe","topics":["map","events"]})");
  client.receive({{"topic", "map"}});
  client.send(R"({"op":"unsubscribe","topics":["map"]})");
  EXPECT_EQ(client.receive({{"op", "subscribed"}})["topics"], (Json{"events"}));
  set_map(2, 1);
  EXPECT_EQ(client.receive()["data"]["event"], "object_found");  // the map would have been with it
  client.send(R"({"op":"unsubscribe"})");
  EXPECT_EQ(client.receive()["topics"], Json::array());
}

TEST_F(ServerTest, QueriesOverTheStream) {
  start();
  set_map(4, 3);
  StreamClient client(port_);
  client.send(R"({"op":"query","id":1,"path":"objects","params":{"near":[3,0],"limit":1}})");
  auto reply = client.receive();
  EXPECT_EQ(reply["op"], "result");
  EXPECT_EQ(reply["id"], 1);
  EXPECT_EQ(reply["data"]["objects"][0]["id"], 3);
  client.send(R"({"op":"query","id":"b","path":"objects/99"})");
  reply = client.receive();
  EXPECT_EQ(reply["op"], "error");
  EXPECT_EQ(reply["id"], "b");
  EXPECT_EQ(reply["error"]["code"], "not_found");
  for (const char* path : {"map", "trajectory", "status", "objects/2"}) {
    client.send(Json{{"op", "query"}, {"id", 2}, {"path", path}}.dump());
    EXPECT_EQ(client.receive()["op"], "result") << path;
  }
  client.send(R"({"op":"query","id":3,"path":"export/scene.glb"})");
  EXPECT_EQ(client.receive()["error"]["code"], "not_json");
  client.send(R"({"op":"query","id":3,"path":"nothing"})");
  EXPECT_EQ(client.receive()["error"]["code"], "not_found");
}

TEST_F(ServerTest, GarbageOnTheStreamIsAnsweredNotPunished) {
  start();
  StreamClient client(port_);
  for (const char* garbage : {"", "{", "[]", R"({"op":"dance"})", R"({"op":"subscribe","topics":["mop"]})"}) {
    client.send(garbage);
    EXPECT_EQ(client.receive()["error"]["code"], "bad_message") << garbage;
  }
  client.send("\x01\x02", true);
  EXPECT_THAT(client.receive()["error"]["message"].get<std::string>(), HasSubstr("text frames"));
  client.send(R"({"op":"query","id":1,"path":"map"})");
  EXPECT_EQ(client.receive()["op"], "result");
}

TEST_F(ServerTest, AnOversizedMessageClosesTheStream) {
  start();
  StreamClient client(port_);
  client.try_send(std::string(300 * 1024, ' '));
  EXPECT_EQ(client.receive()["closed"], 1009);  // too big
  EXPECT_TRUE(eventually([&] { return status()["clients"]["streams"] == 0; }));
}

TEST_F(ServerTest, AClientThatAsksWithoutReadingIsDisconnected) {
  Config::Api config;
  config.client_buffer_bytes = 65536;
  start(config, {std::chrono::milliseconds(2000)});
  set_map(1, 2000);  // half a megabyte of JSON
  StreamClient flooder(port_, 4096), late_reader(port_, 4096), other(port_);
  for (int i = 0; i < 50 && flooder.try_send(R"({"op":"query","id":1,"path":"map"})"); ++i) {
  }
  EXPECT_TRUE(eventually([&] { return status()["clients"]["slow_clients_closed"] == 1; }));
  EXPECT_TRUE(eventually([&] { return status()["clients"]["streams"] == 2; }));
  // One that reads after all gets the message that was under way, and then is told why it is closed.
  for (int i = 0; i < 50 && late_reader.try_send(R"({"op":"query","id":1,"path":"map"})"); ++i) {
  }
  EXPECT_TRUE(eventually([&] { return status()["clients"]["slow_clients_closed"] == 2; }));
  const auto goodbye = late_reader.receive({{"closed", 1008}});
  EXPECT_EQ(goodbye["closed"], 1008);
  EXPECT_THAT(goodbye["reason"].get<std::string>(), HasSubstr("slow reader"));
  other.send(R"({"op":"query","id":2,"path":"map"})");
  EXPECT_EQ(other.receive()["id"], 2);
}

TEST_F(ServerTest, AStoppedReaderSkipsToTheNewestAndIsThenDisconnected) {
  start({}, {std::chrono::milliseconds(2000)});
  StreamClient stopped(port_, 4096), reader(port_);
  const std::string subscribe = R"({"op":"subscribe","topics":["map"]})";
  stopped.send(subscribe);
  reader.send(subscribe);
  // The other client gets every map meanwhile.
  std::uint64_t revision = 0;
  const auto next_map_arrives = [&] {
    ++revision;
    // All objects move: a quarter of a megabyte of JSON, of which a few fill the kernel's buffers.
    set_map(revision, 1000, static_cast<double>(revision));
    Json message;
    do message = reader.receive({{"topic", "map"}});
    while (!message.contains("closed") && message["data"]["revision"] != revision);
    return !message.contains("closed");
  };
  EXPECT_TRUE(eventually([&] { return !next_map_arrives() || status()["clients"]["messages_skipped"] > 0; }));
  EXPECT_TRUE(eventually([&] { return !next_map_arrives() || status()["clients"]["slow_clients_closed"] == 1; }));
  EXPECT_TRUE(next_map_arrives());
  EXPECT_EQ(status()["clients"]["streams"], 1);
}

TEST_F(ServerTest, StartsAndStopsFiftyTimesWithClients) {
  for (int i = 0; i < 50; ++i) {
    start();
    StreamClient client(port_);
    client.send(R"({"op":"subscribe","topics":["map","pose","status"]})");
    HttpClient idle(port_);
    if (i % 2 == 0) client.receive();
    server_.reset();
  }
}

}  // namespace
}  // namespace kinemap
