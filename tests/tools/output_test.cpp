// SPDX-License-Identifier: Apache-2.0
#include <expat.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "protocol/export/exports.hpp"
#include "protocol/map_json.hpp"
#include "tests/protocol/sample_map.hpp"
#include "tools/kinemap/endpoint.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/news.hpp"
#include "tools/kinemap/object_table.hpp"
#include "tools/kinemap/plan_text.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;

class Directory : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("kinemap-output-test-" + std::to_string(::getpid()));
    fs::create_directories(path_);
  }
  void TearDown() override { fs::remove_all(path_); }
  [[nodiscard]] std::string at(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), {}));
  }
  fs::path path_;
};

using Files = Directory;

TEST_F(Files, WritesReadsAndReplaces) {
  ASSERT_FALSE(write_file(at("a"), "one"));
  ASSERT_FALSE(write_file(at("a"), std::string(100000, 'x')));
  const auto text = read_file(at("a"));
  ASSERT_TRUE(text) << text.error();
  EXPECT_EQ(text->size(), 100000U);
  EXPECT_EQ(entries(), 1U) << "no temporary file is left";
}

TEST_F(Files, ErrorsNameThePath) {
  EXPECT_EQ(read_file(at("none")).error(), at("none") + ": cannot be opened: No such file or directory");
  EXPECT_EQ(read_file(path_.string()).error(), path_.string() + ": cannot be read: Is a directory");
  EXPECT_EQ(write_file(at("no/such/dir"), "x")->message,
            at("no/such/dir") + ": cannot be written: No such file or directory");
  ASSERT_FALSE(write_file(at("file"), "x"));
  EXPECT_NE(make_output_directory(at("file")), std::nullopt);
  EXPECT_NE(make_output_directory(at("file/below")), std::nullopt);
  EXPECT_EQ(make_output_directory(at("new/deep")), std::nullopt);
  EXPECT_TRUE(fs::is_directory(at("new/deep")));
}

TEST_F(Files, AFullDiskLeavesTheOldFileWhole) {
  ASSERT_FALSE(write_file(at("a"), "old"));
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{1000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &little);
  const auto error = write_file(at("a"), std::string(100000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, at("a") + ": cannot be written: File too large");
  EXPECT_EQ(*read_file(at("a")), "old");
  EXPECT_EQ(entries(), 1U) << "no temporary file is left";
}

TEST_F(Files, MapFilesRoundTrip) {
  const MapSnapshot map = sample_map();
  ASSERT_FALSE(write_map_files(path_.string(), map));
  for (const Export& file : exports()) EXPECT_TRUE(fs::exists(at(file.name))) << file.name;
  EXPECT_EQ(entries(), exports().size());
  for (const std::string& path : {path_.string(), at("map.json")}) {
    const auto read = read_map_files(path);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->objects.size(), 4U);
    ASSERT_EQ(read->trajectory.size(), 4U);
    EXPECT_LT((read->trajectory[2].T_odom_pelvis.p - map.trajectory[2].T_odom_pelvis.p).norm(), 1e-5);
  }
}

TEST_F(Files, MapFilesThatDoNotBelongTogetherAreRefused) {
  MapSnapshot map = sample_map();
  ASSERT_FALSE(write_map_files(path_.string(), map));
  map.trajectory.pop_back();
  ASSERT_FALSE(write_file(at("odometry.tum"), "0 1 2 3 0 0 0 1\n"));
  EXPECT_NE(read_map_files(path_.string()).error().find("both must come from one build"), std::string::npos);
  ASSERT_FALSE(write_file(at("odometry.tum"), "nonsense"));
  EXPECT_EQ(read_map_files(path_.string()).error(),
            at("odometry.tum") + ": line 1: expected 8 numbers: t x y z qx qy qz qw");
  fs::remove(at("trajectory.tum"));
  EXPECT_FALSE(read_map_files(path_.string())) << "a directory must be whole";
  const auto lone = read_map_files(at("map.json"));
  ASSERT_TRUE(lone) << lone.error();
  EXPECT_TRUE(lone->trajectory.empty()) << "a lone map.json is fine";
}

TEST(Endpoint, Parses) {
  const auto parse = [](const std::string& text) {
    const auto endpoint = parse_endpoint(text, "127.0.0.1", 8765);
    return endpoint ? endpoint->text() : "error";
  };
  EXPECT_EQ(parse("host:1"), "host:1");
  EXPECT_EQ(parse("host"), "host:8765");
  EXPECT_EQ(parse(":99"), "127.0.0.1:99");
  EXPECT_EQ(parse("[::1]:5"), "[::1]:5");
  EXPECT_EQ(parse("[::1]"), "[::1]:8765");
  EXPECT_EQ(parse("::1"), "[::1]:8765");
  for (const char* bad : {"host:", "host:0", "host:65536", "host:x", "host:1x", "[::1", "[::1]5", "[]:5", "host:-1"})
    EXPECT_EQ(parse(bad), "error") << bad;
}

TEST(TextTable, AlignsByWhatIsSeen) {
  EXPECT_EQ(text_table({{"a", "size"}, {"long", "1 × 2"}, {"b", ""}}, {0}), "a      size\nlong  1 × 2\nb\n");
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST(ObjectTable, NamesAllAndMarksAssumedHeights) {
  const std::string table = object_table(sample_map().objects);
  EXPECT_NE(table.find("3.00 × 2.50*"), std::string::npos) << table;
  EXPECT_NE(table.find("* height assumed, not observed"), std::string::npos);
  EXPECT_NE(table.find("chair"), std::string::npos);
  EXPECT_EQ(object_counts(sample_map()), "4 objects: 1 wall, 1 table, 1 screen, 1 chair; room 1 of 10.0 m²");
  EXPECT_EQ(object_counts(MapSnapshot{}), "0 objects");
}

TEST(Plan, WallsRunLevelOrUprightWhateverTheFrame) {
  for (const double heading : {0.0, 0.4, -0.7, 1.5, 3.0}) {
    MapSnapshot map = sample_map();
    const Pose T = level_pose({3, 4, 0}, heading);
    for (MapObject& object : map.objects) {
      object.pose = T * object.pose;
      if (!object.plane) continue;
      object.plane->normal = T.q * object.plane->normal;
      for (Eigen::Vector3d& corner : *object.corners) corner = T * corner;
    }
    map.rooms.clear();
    map.trajectory.clear();
    const Plan plan = make_plan(map);
    ASSERT_EQ(plan.items.size(), 4U);
    EXPECT_EQ(plan.items[0].type, ObjectType::Table) << "drawn first: other things stand on it";
    const auto wall = std::find_if(plan.items.begin(), plan.items.end(),
                                   [](const Plan::Item& item) { return item.type == ObjectType::Wall; });
    ASSERT_NE(wall, plan.items.end());
    const Eigen::Vector2d along = wall->outline[1] - wall->outline[0];
    EXPECT_NEAR(along.norm(), 3.0, 1e-9);
    EXPECT_NEAR(along.cwiseAbs().minCoeff(), 0.0, 1e-9) << heading;
    const Eigen::Vector2d extent = plan.high - plan.low;
    EXPECT_GE(extent.x(), extent.y());
  }
}

bool is_well_formed(const std::string& xml) {
  XML_Parser parser = XML_ParserCreate(nullptr);
  const bool ok = XML_Parse(parser, xml.data(), static_cast<int>(xml.size()), 1) == XML_STATUS_OK;
  XML_ParserFree(parser);
  return ok;
}

TEST(Plan, SvgIsWellFormedAndNamesAllObjects) {
  const std::string svg = plan_svg(sample_map());
  EXPECT_TRUE(is_well_formed(svg));
  for (const char* text : {"W1 · ≥ 3.00 m", "T2", "1.60 × 0.80 m", "S5 · 1.00 × 0.60 m", "C7", "10.0 m²", "2 m"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_TRUE(is_well_formed(plan_svg(MapSnapshot{})));
}

TEST(Plan, TextFitsTheTerminal) {
  const Plan plan = make_plan(sample_map());
  for (const int columns : {20, 80, 200})
    for (const int rows : {8, 40}) {
      const std::string text = plan_text(plan, columns, rows, false);
      std::size_t lines = 0;
      for (std::size_t at = 0; at < text.size(); ++lines) {
        const std::size_t end = text.find('\n', at);
        const std::string line = text.substr(at, end - at);
        const bool is_key = line.find("W wall") != std::string::npos;  // a line of its own where it does not fit
        EXPECT_LE(is_key ? 0 : display_width(line), static_cast<std::size_t>(columns)) << line;
        at = end + 1;
      }
      EXPECT_LE(lines, static_cast<std::size_t>(rows) + 2);
      EXPECT_EQ(text.find('\033'), std::string::npos);
    }
  const std::string text = plan_text(plan, 100, 40, false);
  for (const char* name : {"W1", "T2", "S5", "C7"})
    EXPECT_NE(text.find(name), std::string::npos) << name << '\n' << text;
  EXPECT_NE(plan_text(plan, 100, 40, true).find("\033["), std::string::npos);
  EXPECT_EQ(plan_text(make_plan(MapSnapshot{}), 80, 40, false), "nothing to draw yet\n");
}

std::string map_message(const MapSnapshot& map) {
  return R"({"op":"message","topic":"map","data":)" + map_text(map) + "}";
}

TEST(News, TellsWhatIsNewChangedAndGone) {
  News news;
  MapSnapshot map = sample_map();
  const std::string first = news.lines(map_message(map));
  EXPECT_NE(first.find("revision 42"), std::string::npos) << first;
  EXPECT_NE(first.find("+ table 2  1.60 × 0.80 m"), std::string::npos) << first;
  map.objects[0].pose.p.x() += 0.01;  // too little to tell
  map.objects[1].pose.p.x() += 0.10;
  map.objects.pop_back();
  // What is gone and what has changed, as a delta has it.
  nlohmann::ordered_json delta = to_json(map);
  delta.erase("unresolved");
  delta["run"] = "";
  delta["since"] = 42;
  delta["removed"] = {{"objects", {7}}, {"rooms", nlohmann::ordered_json::array()}};
  const std::string second = news.lines(R"({"op":"message","topic":"map","data":)" + delta.dump() + "}");
  EXPECT_NE(second.find("~ table 2"), std::string::npos) << second;
  EXPECT_NE(second.find("(by 0.10 m)"), std::string::npos) << second;
  EXPECT_NE(second.find("- chair 7"), std::string::npos) << second;
  EXPECT_EQ(second.find("wall"), std::string::npos) << second;
}

TEST(News, EventsAndRubbish) {
  News news;
  EXPECT_EQ(
      news.lines(
          R"({"op":"message","topic":"events","data":{"event":"sitting","begin":1,"end":4.5,"seat_height":0.45}})"),
      "1.0–4.5 s  sat down, seat 0.45 m high\n");
  EXPECT_EQ(
      news.lines(
          R"({"op":"message","topic":"events","data":{"event":"loop_closed","time":7.5,"message":"loop closed: 3"}})"),
      "7.5 s  loop closed: 3\n");
  EXPECT_EQ(news.lines(R"({"op":"error","error":{"code":"bad_message","message":"no"}})"), "error: no\n");
  EXPECT_EQ(news.lines(R"({"op":"subscribed","topics":[]})"), "");
  for (const char* rubbish :
       {"", "nonsense", "[]", "3", R"({"op":3})", R"({"op":"message"})", R"({"op":"message","topic":"map","data":7})",
        R"({"op":"message","topic":"pose","data":{"position":["a","b","c"]}})",
        R"({"op":"message","topic":"status","data":[]})", R"({"op":"message","topic":"events","data":3})"})
    EXPECT_NO_THROW(news.lines(rubbish)) << rubbish;
}

}  // namespace
}  // namespace kinemap::cli
