// SPDX-License-Identifier: Apache-2.0
// The container's structure; that others can read it is checked by tests/foxglove with npm's @mcap/core.
#include "protocol/mcap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "protocol/foxglove/session.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

/// A record as it stands in a file.
struct Record {
  unsigned char op;
  std::string body;
};

std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// All records between the magics; ends where a length reaches beyond the end.
std::vector<Record> records(std::string_view bytes) {
  std::vector<Record> list;
  while (bytes.size() >= 9) {
    const std::uint64_t length = number(bytes, 1, 8);
    if (length > bytes.size() - 9) break;
    list.push_back({static_cast<unsigned char>(bytes[0]), std::string(bytes.substr(9, length))});
    bytes.remove_prefix(9 + length);
  }
  return list;
}

std::string written(std::size_t messages, std::size_t bytes_each) {
  std::string file;
  mcap::Writer writer([&](std::string_view part) { file += part; }, "test",
                      {{"/a", "json", "A", "jsonschema", "{}"}, {"/b", "json", "B", "jsonschema", "{}"}});
  for (std::size_t i = 0; i < messages; ++i) writer.write(i % 2, 1000 * i, std::string(bytes_each, 'x'));
  writer.finish();
  return file;
}

std::string ops(const std::string& file) {
  std::string text;
  for (const Record& record : records(std::string_view(file).substr(8, file.size() - 16)))
    text += "0123456789ABCDEF"[record.op];
  return text;
}

TEST(Mcap, HasHeaderChannelsChunksAndSummaryBetweenTwoMagics) {
  const std::string file = written(3, 10);
  const std::string magic("\x89MCAP0\r\n", 8);
  EXPECT_EQ(file.substr(0, 8), magic);
  EXPECT_EQ(file.substr(file.size() - 8), magic);
  EXPECT_EQ(ops(file), "13434677F3344B8EEEE2");
  EXPECT_EQ(ops(written(0, 0)), "13434F3344BEEE2");
}

TEST(Mcap, TheFooterLeadsToTheSummary) {
  const std::string file = written(3, 10);
  const std::string footer = records(std::string_view(file).substr(8, file.size() - 16)).back().body;
  EXPECT_EQ(file[number(footer, 0, 8)], 0x03);
  EXPECT_EQ(file[number(footer, 8, 8)], 0x0E);
}

TEST(Mcap, ChunksAreClosedSoThatLittleIsLostWhenAFileIsCutShort) {
  const std::string file = written(1000, 1000);  // 1 MB
  std::size_t chunks = 0, indexed = 0;
  const std::string* chunk = nullptr;
  const auto all = records(std::string_view(file).substr(8));
  for (const Record& record : all) {
    if (record.op == 0x06) {
      ++chunks;
      chunk = &record.body;
      EXPECT_LT(record.body.size(), 300000U);
    }
    if (record.op != 0x07) continue;
    const std::size_t records_at = 8 + 8 + 8 + 4 + 4 + 8;  // in the chunk, compression being ""
    for (std::size_t i = 6; i < record.body.size(); i += 16, ++indexed) {
      const std::size_t at = records_at + number(record.body, i + 8, 8);
      EXPECT_EQ((*chunk)[at], 0x05);
      EXPECT_EQ(number(*chunk, at + 9, 2), number(record.body, 0, 2)) << "channel";
      EXPECT_EQ(number(*chunk, at + 15, 8), number(record.body, i, 8)) << "time";
    }
  }
  EXPECT_EQ(chunks, 4U);
  EXPECT_EQ(indexed, 1000U);
}

/// Topic → times of its messages, of all that is in whole chunks; each message is JSON.
std::map<std::string, std::vector<double>> session(const std::string& file) {
  std::map<std::uint64_t, std::string> topics;
  std::map<std::string, std::vector<double>> times;
  for (const Record& record : records(std::string_view(file).substr(8))) {
    if (record.op == 0x04) topics[number(record.body, 0, 2)] = record.body.substr(8, number(record.body, 4, 4));
    if (record.op != 0x06) continue;
    for (const Record& message : records(std::string_view(record.body).substr(40))) {
      times[topics[number(message.body, 0, 2)]].push_back(1e-9 * static_cast<double>(number(message.body, 6, 8)));
      EXPECT_TRUE(nlohmann::json::accept(message.body.substr(22)));
    }
  }
  return times;
}

TEST(SessionMcap, OfAMapHasTheKeyPosesAndEachObjectFromWhenItWasSeen) {
  auto times = session(foxglove::mcap_bytes(sample_map()));
  EXPECT_THAT(times["/tf"], testing::ElementsAre(0.0, 0.5, 1.0, 1.5));
  EXPECT_THAT(times["/map/scene"], testing::ElementsAre(0, 0, 0, 0, 0, 12.5));  // the sample's wall alone has a time
  EXPECT_THAT(times["/map/trajectory"], testing::ElementsAre(0.0));
  EXPECT_THAT(times["/map/floor"], testing::ElementsAre(0.0));
  EXPECT_THAT(times["/log"], testing::ElementsAre(12.5, 90.0, 166.0));
  EXPECT_EQ(session(foxglove::mcap_bytes({}))["/tf"].size(), 0U);
}

TEST(SessionMcap, WhileItIsMappedHasTheBodyAtItsRateAndTheMapByRevision) {
  std::string file;
  foxglove::SessionRecorder recorder([&](std::string_view part) { file += part; }, 10.0);
  MapSnapshot map;
  for (std::uint64_t i = 0; i <= 1200; ++i) {
    SuitFrame frame;
    frame.index = i;
    frame.time_s = static_cast<double>(i) / 120.0;
    if (i == 600) map = sample_map();
    map.time_s = frame.time_s;
    recorder.add(frame, map);
  }
  ++map.revision;
  map.objects.pop_back();
  recorder.finish(map);
  auto times = session(file);
  EXPECT_EQ(times["/tf"].size(), 101U);
  EXPECT_THAT(times["/map/scene"], testing::ElementsAre(5.0, 10.0));
  EXPECT_THAT(times["/map/trajectory"], testing::ElementsAre(5.0, 10.0, 10.0));
  EXPECT_EQ(times["/log"].size(), 7U);  // four objects, a closure and one taken back; an object gone
}

}  // namespace
}  // namespace kinemap
