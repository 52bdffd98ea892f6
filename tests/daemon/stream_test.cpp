// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "daemon/foxglove_protocol.hpp"
#include "daemon/json_params.hpp"
#include "daemon/outbox.hpp"
#include "daemon/stream_protocol.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

Outbox::Text text(std::size_t bytes, char c = 'x') { return std::make_shared<const std::string>(bytes, c); }

TEST(Outbox, AnswersComeFirstAndInTheirOrder) {
  Outbox box(1000);
  box.add_news(Topic::Pose, text(1, 'p'));
  box.add_news(Topic::Map, text(1, 'm'));
  box.add_news(Topic::Events, text(1, 'e'));
  EXPECT_TRUE(box.add_answer(text(1, '1')));
  EXPECT_TRUE(box.add_answer(text(1, '2')));
  std::string order;
  while (const auto next = box.next().text) order += *next;
  EXPECT_EQ(order, "12emp");
  EXPECT_EQ(box.bytes(), 0U);
}

TEST(Outbox, NewerNewsReplaceOlderOnes) {
  Outbox box(1000);
  EXPECT_EQ(box.add_news(Topic::Map, text(10, 'a')).skipped, 0U);
  EXPECT_EQ(box.add_news(Topic::Map, text(20, 'b')).skipped, 1U);
  EXPECT_EQ(box.bytes(), 20U);
  EXPECT_EQ(box.next().text->front(), 'b');
  EXPECT_EQ(box.next().text, nullptr);
}

TEST(Outbox, OldestEventsGiveWay) {
  Outbox box(100);
  for (const char c : {'a', 'b', 'c'}) EXPECT_TRUE(box.add_news(Topic::Events, text(40, c)).added);
  EXPECT_EQ(box.bytes(), 80U);
  EXPECT_EQ(box.next().text->front(), 'b');
}

TEST(Outbox, NewsBeyondTheBudgetWaitButAnythingFitsIntoAnEmptyBox) {
  Outbox box(100);
  EXPECT_TRUE(box.add_news(Topic::Map, text(500)).added);
  EXPECT_FALSE(box.add_news(Topic::Pose, text(1)).added);
  EXPECT_EQ(box.next().text->size(), 500U);
  EXPECT_TRUE(box.add_news(Topic::Pose, text(1)).added);
}

TEST(Outbox, AnswersBeyondTheBudgetEndTheConnection) {
  Outbox box(100);
  EXPECT_TRUE(box.add_answer(text(500)));  // one is always sent
  EXPECT_FALSE(box.add_answer(text(1)));
}

TEST(Outbox, ForgetsATopic) {
  Outbox box(100);
  box.add_news(Topic::Events, text(10));
  box.add_news(Topic::Status, text(10));
  box.forget(Topic::Events);
  box.forget(Topic::Status);
  EXPECT_EQ(box.bytes(), 0U);
  EXPECT_EQ(box.next().text, nullptr);
}

template <class T>
T parsed(const std::string& message) {
  auto result = parse_client_message(message);
  EXPECT_TRUE(std::holds_alternative<T>(result)) << message;
  return std::holds_alternative<T>(result) ? std::get<T>(std::move(result)) : T{};
}

TEST(StreamProtocol, SubscribeAndUnsubscribe) {
  EXPECT_EQ(parsed<Subscribe>(R"({"op":"subscribe","topics":["pose","map"]})").topics,
            (std::vector{Topic::Pose, Topic::Map}));
  EXPECT_EQ(parsed<Unsubscribe>(R"({"op":"unsubscribe","topics":["events"]})").topics, (std::vector{Topic::Events}));
  EXPECT_EQ(parsed<Unsubscribe>(R"({"op":"unsubscribe"})").topics.size(), kTopicCount);
}

TEST(StreamProtocol, ASubscriberChoosesItsRateAndSaysWhichMapItHas) {
  const auto plain = parsed<Subscribe>(R"({"op":"subscribe","topics":["pose"]})");
  EXPECT_FALSE(plain.rate_hz || plain.known);
  const auto full = parsed<Subscribe>(R"({"op":"subscribe","topics":["map"],"rate_hz":2.5,"since":42,"run":"ab"})");
  EXPECT_EQ(full.rate_hz, 2.5);
  EXPECT_EQ(full.known->revision, 42U);
  EXPECT_EQ(full.known->run, "ab");
  const auto message = [](const std::string& more) {
    return parsed<BadMessage>(R"({"op":"subscribe","topics":["map"],)" + more + "}").error.message;
  };
  for (const char* more : {R"("rate_hz":0)", R"("rate_hz":1000)", R"("rate_hz":"10")", R"("rate_hz":null)"})
    EXPECT_THAT(message(more), HasSubstr("number from 0.1 to 240, not ")) << more;
  for (const char* more : {R"("since":-1)", R"("since":1.5)", R"("since":"a")"})
    EXPECT_THAT(message(more), HasSubstr("revision of the map that you have")) << more;
  for (const char* more : {R"("run":"a")", R"("since":1,"run":2)"})
    EXPECT_THAT(message(more), HasSubstr("\"run\" must be")) << more;
}

TEST(StreamProtocol, QueryParametersAreAsInAUrl) {
  const auto query = parsed<StreamQuery>(
      R"({"op":"query","id":"a\"1","path":"objects","params":{"near":[1,-2.5],"limit":3,"type":"wall","x":["a","b"]}})");
  EXPECT_EQ(query.id, R"("a\"1")");
  EXPECT_EQ(query.path, "objects");
  EXPECT_THAT(query.params, testing::UnorderedElementsAre(testing::Pair("near", "1,-2.5"), testing::Pair("limit", "3"),
                                                          testing::Pair("type", "wall"), testing::Pair("x", "a,b")));
}

TEST(StreamProtocol, BadMessagesSayWhatIsAllowed) {
  const auto message = [](const std::string& json) { return parsed<BadMessage>(json).error.message; };
  for (const char* json : {"", "{", "7", "[]", "\"op\"", "{}}", "\xff\xfe"})
    EXPECT_THAT(message(json), HasSubstr("JSON object")) << json;
  for (const char* json : {"{}", R"({"op":7})", R"({"op":"dance"})"})
    EXPECT_THAT(message(json), HasSubstr("subscribe, unsubscribe or query"));
  for (const char* json :
       {R"({"op":"subscribe"})", R"({"op":"subscribe","topics":"map"})", R"({"op":"subscribe","topics":[1]})",
        R"({"op":"subscribe","topics":["mop"]})", R"({"op":"unsubscribe","topics":{}})"})
    EXPECT_THAT(message(json), HasSubstr("map, pose, body, status, events"));
  for (const char* json : {R"({"op":"query","path":"map"})", R"({"op":"query","id":null,"path":"map"})"})
    EXPECT_THAT(message(json), HasSubstr("needs an \"id\""));
  EXPECT_THAT(message(R"({"op":"query","id":1})"), HasSubstr("needs a \"path\""));
  EXPECT_THAT(message(R"({"op":"query","id":1,"path":"map","params":[]})"), HasSubstr("must be an object"));
  EXPECT_THAT(message(R"({"op":"query","id":1,"path":"map","params":{"a":{}}})"), HasSubstr("parameter a must be"));
  EXPECT_THAT(message(R"({"op":"query","id":1,"path":"map","params":{"a":[[1]]}})"), HasSubstr("parameter a must be"));
  EXPECT_THAT(message(R"({"op":"query","id":")" + std::string(300, 'x') + R"(","path":"map"})"),
              HasSubstr("longer than 200"));
  EXPECT_EQ(parsed<BadMessage>(R"({"op":"query","id":1})").id, "1");
  // Deep nesting must not exhaust the stack.
  EXPECT_THAT(message(std::string(200000, '[')), HasSubstr("JSON object"));
}

TEST(StreamProtocol, DeepNestingIsRefused) {
  constexpr std::size_t kLevels = 130000;  // as many as fit into one message
  const std::string deep = std::string(kLevels, '[') + std::string(kLevels, ']');
  for (const std::string& text : {R"({"op":"query","id":)" + deep + R"(,"path":"objects"})", deep}) {
    EXPECT_TRUE(std::holds_alternative<BadMessage>(parse_client_message(text)));
    EXPECT_TRUE(std::holds_alternative<foxglove::BadMessage>(foxglove::parse_text(text)));
  }
  EXPECT_TRUE(parse_message(R"({"a":)" + deep + R"(,"b":1})").is_discarded());
}

TEST(StreamProtocol, AnswersAreJson) {
  EXPECT_EQ(Json::parse(result_text("1", R"({"a":2})")), Json::parse(R"({"op":"result","id":1,"data":{"a":2}})"));
  EXPECT_EQ(Json::parse(stream_error_text("\"x\"", error_text({404, "not_found", "no"}))),
            Json::parse(R"({"op":"error","id":"x","error":{"code":"not_found","message":"no"}})"));
  EXPECT_FALSE(Json::parse(stream_error_text("", error_text({400, "bad", "no"}))).contains("id"));
  EXPECT_EQ(Json::parse(news_text(Topic::Map, "[]")), Json::parse(R"({"op":"message","topic":"map","data":[]})"));
  EXPECT_EQ(Json::parse(subscribed_text({Topic::Events, Topic::Pose}, {{Topic::Pose, 10.0}})),
            Json::parse(R"({"op":"subscribed","topics":["events","pose"],"rate_hz":{"pose":10.0}})"));
}

}  // namespace
}  // namespace kinemap
