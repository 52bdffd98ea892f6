// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/exports.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "protocol/export/objects_csv.hpp"
#include "protocol/map_json.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string made(const char* name, const MapSnapshot& map) {
  const auto bytes = export_map(*find_export(name), map);
  return bytes ? *bytes : "error: " + bytes.error();
}

/// For the readers that are not ours.
void write_all(const std::string& folder, const MapSnapshot& map) {
  const std::filesystem::path directory = std::filesystem::path(KINEMAP_BINARY_DIR) / "exports" / folder;
  std::filesystem::create_directories(directory);
  for (const Export& file : exports()) {
    const auto bytes = export_map(file, map);
    ASSERT_TRUE(bytes) << bytes.error();
    EXPECT_FALSE(bytes->empty()) << file.name;
    EXPECT_EQ(*bytes, *export_map(file, map)) << file.name << ": the same map gives the same bytes";
    std::ofstream(directory / file.name, std::ios::binary) << *bytes;
  }
}

TEST(Exports, EveryFileOfAMapAndOfAnEmptyOne) {
  write_all("sample", sample_map());
  write_all("empty", {});
}

TEST(Exports, NamesAreFoundAndUnique) {
  std::set<std::string> names;
  for (const Export& file : exports()) {
    EXPECT_TRUE(names.insert(file.name).second) << file.name;
    EXPECT_EQ(find_export(file.name), &file);
  }
  EXPECT_EQ(find_export("scene.gltf"), nullptr);
  EXPECT_EQ(find_export(""), nullptr);
}

TEST(Exports, WhatAMapFromAFileLacksIsSaid) {
  auto map = map_from_text(map_text(sample_map()));
  ASSERT_TRUE(map) << map.error();
  EXPECT_THAT(made("trajectory.tum", *map), HasSubstr("trajectory.tum needs the trajectory"));
  EXPECT_THAT(made("floor.pgm", *map), HasSubstr("floor.pgm needs the trajectory"));
  EXPECT_THAT(made("plan.svg", *map), StartsWith("<svg"));
  map->trajectory = sample_map().trajectory;
  EXPECT_THAT(made("trajectory.tum", *map), StartsWith("# t x y z"));
  EXPECT_THAT(made("graph.g2o", *map), StartsWith("# kinemap"));
  for (TrajectoryPose& pose : map->trajectory) pose.step = {};
  EXPECT_THAT(made("graph.g2o", *map), HasSubstr("needs the noise of the odometry"));
}

TEST(ObjectsCsv, QuotesWhatNeedsIt) {
  MapSnapshot map = sample_map();
  map.objects[3].functions = {"sit", "say \"a, b\""};
  const std::string csv = objects_csv(map);
  EXPECT_THAT(csv, HasSubstr("7,chair,\"sit; say \"\"a, b\"\"\",1,2.000,0.200,0.460,90.0,,,,"));
  EXPECT_THAT(csv,
              HasSubstr("1,wall,bound,1,4.000,1.500,1.250,180.0,3.000,2.500,true,true,0.030,0.6,0.050,,3,12.500,170.000"));
}

}  // namespace
}  // namespace kinemap
