// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kinemap::gltf {

/// Triangles (or, without indices and normals, a line strip) in the frame of the node that will show them.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::uint32_t> indices;

  /// A flat convex face, corners counter-clockwise when seen from where `normal` points.
  void add_face(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal);
};

struct Material {
  std::string name;              ///< the same name is the same material
  std::array<double, 4> colour;  ///< red, green, blue, opacity, each 0–1 (linear)
};

/// The slab over a convex outline `top` (counter-clockwise when seen from `normal`, unit), `thickness` m deep against
/// the normal.
Mesh slab(const std::vector<Eigen::Vector3d>& top, const Eigen::Vector3d& normal, double thickness);

/// Collects meshes and nodes, and writes the .glb container: a 12-byte header, the JSON chunk, the BIN chunk.
class Builder {
 public:
  Builder();
  /// A node with its mesh; an empty mesh gives a node without one.
  void add_node(const std::string& name, const Mesh& mesh, const Material& material,
                nlohmann::ordered_json extras = nullptr);
  [[nodiscard]] std::string bytes() const;

 private:
  std::size_t index_of(const Material& material);
  int add_accessor(const std::vector<Eigen::Vector3f>& vectors, bool bounds);
  int add_indices(const std::vector<std::uint32_t>& indices);
  int add_view(const void* data, std::size_t size, int target);

  nlohmann::ordered_json json_;
  std::string binary_;
};

}  // namespace kinemap::gltf
