// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/gltf_builder.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace kinemap::gltf {
namespace {

using Json = nlohmann::ordered_json;

// Constants of the glTF 2.0 specification.
constexpr int kFloat = 5126, kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kLineStrip = 3, kTriangles = 4;
constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

void append_u32(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xFF);
}

void append_chunk(std::string& bytes, std::uint32_t type, std::string content, char padding) {
  while (content.size() % 4) content += padding;
  append_u32(bytes, static_cast<std::uint32_t>(content.size()));
  append_u32(bytes, type);
  bytes += content;
}

}  // namespace

void Mesh::add_face(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal) {
  const auto base = static_cast<std::uint32_t>(positions.size());
  for (const Eigen::Vector3d& corner : corners) {
    positions.push_back(corner.cast<float>());
    normals.push_back(normal.cast<float>());
  }
  for (std::uint32_t i = 2; i < corners.size(); ++i) indices.insert(indices.end(), {base, base + i - 1, base + i});
}

Mesh slab(const std::vector<Eigen::Vector3d>& top, const Eigen::Vector3d& normal, double thickness) {
  Mesh mesh;
  std::vector<Eigen::Vector3d> bottom(top.rbegin(), top.rend());
  for (Eigen::Vector3d& corner : bottom) corner -= thickness * normal;
  mesh.add_face(top, normal);
  mesh.add_face(bottom, -normal);
  for (std::size_t i = 0; i < top.size(); ++i) {
    const Eigen::Vector3d& a = top[i];
    const Eigen::Vector3d& b = top[(i + 1) % top.size()];
    if ((b - a).norm() < 1e-9) continue;
    const Eigen::Vector3d down = thickness * normal;
    mesh.add_face({a, a - down, b - down, b}, (b - a).cross(normal).normalized());
  }
  return mesh;
}

Builder::Builder() {
  json_ = {{"asset", {{"version", "2.0"}, {"generator", "kinemap"}}}, {"scene", 0}};
  json_["scenes"] = Json::array({{{"name", "Kinemap"}, {"nodes", Json::array({0})}}});
  // Turn by −90° about x: (x, y, z) → (x, z, −y).
  const double s = std::sqrt(0.5);
  json_["nodes"] = Json::array(
      {{{"name", "map (z up)"}, {"rotation", Json::array({-s, 0.0, 0.0, s})}, {"children", Json::array()}}});
}

std::size_t Builder::index_of(const Material& material) {
  Json& materials = json_["materials"];
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (materials[i]["name"] == material.name) return i;
  Json json = {{"name", material.name},
               {"pbrMetallicRoughness",
                {{"baseColorFactor", material.colour}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}},
               {"doubleSided", true}};
  if (material.colour[3] < 1.0) json["alphaMode"] = "BLEND";
  materials.push_back(std::move(json));
  return materials.size() - 1;
}

void Builder::add_node(const std::string& name, const Mesh& mesh, const Material& material, Json extras) {
  Json node = {{"name", name}};
  if (!mesh.positions.empty()) {
    Json attributes = {{"POSITION", add_accessor(mesh.positions, true)}};
    if (!mesh.normals.empty()) attributes["NORMAL"] = add_accessor(mesh.normals, false);
    Json primitive = {{"attributes", std::move(attributes)}, {"material", index_of(material)}, {"mode", kLineStrip}};
    if (!mesh.indices.empty()) {
      primitive["indices"] = add_indices(mesh.indices);
      primitive["mode"] = kTriangles;
    }
    node["mesh"] = json_["meshes"].size();
    json_["meshes"].push_back({{"name", name}, {"primitives", Json::array({std::move(primitive)})}});
  }
  if (!extras.is_null()) node["extras"] = std::move(extras);
  json_["nodes"][0]["children"].push_back(json_["nodes"].size());
  json_["nodes"].push_back(std::move(node));
}

int Builder::add_accessor(const std::vector<Eigen::Vector3f>& vectors, bool bounds) {
  static_assert(sizeof(Eigen::Vector3f) == 12, "glTF wants tightly packed vectors");
  Json accessor = {{"bufferView", add_view(vectors.data(), vectors.size() * sizeof(Eigen::Vector3f), kArrayBuffer)},
                   {"componentType", kFloat},
                   {"count", vectors.size()},
                   {"type", "VEC3"}};
  if (bounds) {
    Eigen::Vector3f low = vectors.front(), high = vectors.front();
    for (const Eigen::Vector3f& v : vectors) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    accessor["min"] = {low.x(), low.y(), low.z()};
    accessor["max"] = {high.x(), high.y(), high.z()};
  }
  json_["accessors"].push_back(std::move(accessor));
  return static_cast<int>(json_["accessors"].size()) - 1;
}

int Builder::add_indices(const std::vector<std::uint32_t>& indices) {
  json_["accessors"].push_back(
      {{"bufferView", add_view(indices.data(), indices.size() * sizeof(std::uint32_t), kElementArrayBuffer)},
       {"componentType", kUnsignedInt},
       {"count", indices.size()},
       {"type", "SCALAR"}});
  return static_cast<int>(json_["accessors"].size()) - 1;
}

int Builder::add_view(const void* data, std::size_t size, int target) {
  json_["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}, {"target", target}});
  binary_.append(static_cast<const char*>(data), size);  // all contents are 4-byte items: offsets stay aligned
  return static_cast<int>(json_["bufferViews"].size()) - 1;
}

std::string Builder::bytes() const {
  Json json = json_;
  // A glTF without geometry has neither buffer nor BIN chunk, and its root node no children.
  if (binary_.empty())
    json["nodes"][0].erase("children");
  else
    json["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  std::string chunks;
  append_chunk(chunks, kJsonChunk, json.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
  if (!binary_.empty()) append_chunk(chunks, kBinChunk, binary_, '\0');
  std::string file;
  append_u32(file, kMagic);
  append_u32(file, 2);
  append_u32(file, static_cast<std::uint32_t>(12 + chunks.size()));
  return file + chunks;
}

}  // namespace kinemap::gltf
