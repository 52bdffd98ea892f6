// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/gltf.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "protocol/triangulate.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

struct Glb {
  Json json;
  std::string binary;
};

/// Takes a container apart as the glTF 2.0 specification has it.
Glb parse(const std::string& bytes) {
  Glb glb;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(u32(bytes, 4), 2U);
  EXPECT_EQ(u32(bytes, 8), bytes.size());
  const std::size_t json_size = u32(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0U);
  glb.json = Json::parse(bytes.substr(20, json_size));
  const std::size_t at = 20 + json_size;
  if (at == bytes.size()) return glb;
  EXPECT_EQ(bytes.substr(at + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(at + 8 + u32(bytes, at), bytes.size());
  EXPECT_EQ(u32(bytes, at) % 4, 0U);
  glb.binary = bytes.substr(at + 8);
  return glb;
}

const Json* node(const Glb& glb, const std::string& name) {
  for (const Json& candidate : glb.json["nodes"])
    if (candidate["name"] == name) return &candidate;
  return nullptr;
}

/// The positions of a node's mesh, in the node's frame.
std::vector<Eigen::Vector3f> positions(const Glb& glb, const std::string& name) {
  const Json& primitive = glb.json["meshes"][(*node(glb, name))["mesh"].get<std::size_t>()]["primitives"][0];
  const Json& accessor = glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::vector<Eigen::Vector3f> result(accessor["count"].get<std::size_t>());
  std::memcpy(static_cast<void*>(result.data()), glb.binary.data() + view["byteOffset"].get<std::size_t>(),
              view["byteLength"]);
  return result;
}

TEST(Gltf, AccessorsLieInsideTheBufferAndStateTheirBounds) {
  const Glb glb = parse(glb_bytes(sample_map()));
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.binary.size());
  for (const Json& accessor : glb.json["accessors"]) {
    const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t item = accessor["type"] == "VEC3" ? 12 : 4;
    EXPECT_EQ(view["byteLength"], item * accessor["count"].get<std::size_t>());
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), glb.binary.size());
  }
  for (const Json& mesh : glb.json["meshes"]) {
    const Json& primitive = mesh["primitives"][0];
    const Json& position = glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    for (const Eigen::Vector3f& p : positions(glb, mesh["name"]))
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GE(p[static_cast<int>(i)], position["min"][i].get<float>());
        EXPECT_LE(p[static_cast<int>(i)], position["max"][i].get<float>());
      }
    if (!primitive.contains("indices")) continue;
    const Json& indices = glb.json["accessors"][primitive["indices"].get<std::size_t>()];
    EXPECT_EQ(indices["count"].get<std::size_t>() % 3, 0U);
    const std::size_t at = glb.json["bufferViews"][indices["bufferView"].get<std::size_t>()]["byteOffset"];
    for (std::size_t i = 0; i < indices["count"]; ++i)
      EXPECT_LT(u32(glb.binary, at + 4 * i), position["count"].get<std::size_t>());
  }
}

TEST(Gltf, OneNodeForEachObjectUnderARootThatTurnsZUp) {
  const Glb glb = parse(glb_bytes(sample_map()));
  const Json& root = glb.json["nodes"][0];
  EXPECT_EQ(root["children"].size(), 6U) << "4 objects, a floor, the trajectory";
  const Eigen::Quaternionf q(root["rotation"][3].get<float>(), root["rotation"][0].get<float>(),
                             root["rotation"][1].get<float>(), root["rotation"][2].get<float>());
  EXPECT_LT((q * Eigen::Vector3f::UnitZ() - Eigen::Vector3f::UnitY()).norm(), 1e-6F);
  ASSERT_TRUE(node(glb, "table 2"));
  const Json& extras = (*node(glb, "table 2"))["extras"];
  EXPECT_EQ(extras["id"], 2);
  EXPECT_EQ(extras["type"], "table");
  EXPECT_EQ(extras["functions"], Json::array({"place"}));
}

TEST(Gltf, TrianglesFaceOutwards) {
  const Glb glb = parse(glb_bytes(sample_map()));
  for (const char* name : {"wall 1", "table 2", "screen 5", "chair 7", "room 1"}) {
    const Json& primitive = glb.json["meshes"][(*node(glb, name))["mesh"].get<std::size_t>()]["primitives"][0];
    const auto read = [&](const Json& accessor, auto item) {
      const Json& view =
          glb.json["bufferViews"][glb.json["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
      std::vector<decltype(item)> items(view["byteLength"].get<std::size_t>() / sizeof item);
      std::memcpy(static_cast<void*>(items.data()), glb.binary.data() + view["byteOffset"].get<std::size_t>(),
                  view["byteLength"]);
      return items;
    };
    const auto p = read(primitive["attributes"]["POSITION"], Eigen::Vector3f());
    const auto n = read(primitive["attributes"]["NORMAL"], Eigen::Vector3f());
    const auto index = read(primitive["indices"], std::uint32_t{});
    for (std::size_t i = 0; i < index.size(); i += 3) {
      const Eigen::Vector3f face = (p[index[i + 1]] - p[index[i]]).cross(p[index[i + 2]] - p[index[i]]);
      EXPECT_GT(face.dot(n[index[i]]), 0.0F) << name << " triangle " << i / 3;
    }
  }
}

TEST(Gltf, TheTableLiesWhereItIs) {
  const Glb glb = parse(glb_bytes(sample_map()));
  float top = -1e9F, low = 1e9F;
  for (const Eigen::Vector3f& p : positions(glb, "table 2")) {
    top = std::max(top, p.z());
    low = std::min(low, p.z());
  }
  EXPECT_FLOAT_EQ(top, 0.74F);
  EXPECT_FLOAT_EQ(low, 0.71F);
}

TEST(Gltf, AnEmptyMapIsAValidFile) {
  const Glb glb = parse(glb_bytes(MapSnapshot{}));
  EXPECT_TRUE(glb.binary.empty());
  EXPECT_FALSE(glb.json.contains("buffers"));
  EXPECT_FALSE(glb.json["nodes"][0].contains("children"));
}

TEST(Triangulate, FillsAnLShapeExactly) {
  const std::vector<Eigen::Vector2d> l = {{0, 0}, {4, 0}, {4, 3}, {2, 3}, {2, 2}, {0, 2}};
  double area = 0.0;
  const auto triangles = triangulate(l);
  EXPECT_EQ(triangles.size(), 4U);
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector2d u = l[b] - l[a], v = l[c] - l[a];
    const double twice = u.x() * v.y() - u.y() * v.x();
    EXPECT_GT(twice, 0.0);
    area += twice / 2;
  }
  EXPECT_DOUBLE_EQ(area, 10.0);
}

TEST(Triangulate, RefusesWhatIsNoPolygon) {
  EXPECT_TRUE(triangulate({}).empty());
  const std::vector<Eigen::Vector2d> line = {{0, 0}, {1, 0}, {2, 0}};
  EXPECT_TRUE(triangulate(line).empty());
}

}  // namespace
}  // namespace kinemap
