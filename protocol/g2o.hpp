// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/graph/graph.hpp"
#include "core/map.hpp"
#include "protocol/wire/result.hpp"

/// SE(3) pose graphs in g2o's text format: VERTEX_SE3:QUAT id x y z qx qy qz qw, EDGE_SE3:QUAT i j x y z qx qy qz qw
/// and the 21 numbers of the upper triangle of the information matrix, FIX id. The information there belongs to (x y z
/// qx qy qz), the vector part of the quaternion: four times that of an angle. It is converted to the tangent of
/// core/graph/graph.hpp and back.
namespace kinemap {

struct G2oGraph {
  graph::Graph graph;  ///< poses by ascending id, between factors in the order of the file, one prior per FIX
  std::vector<std::int64_t> ids;  ///< id in the file of graph.poses[k]
  /// Edges whose information was not positive definite (to 1e-9 of its largest eigenvalue) and was moved to the nearest
  /// that is.
  std::size_t clamped = 0;
  std::vector<std::size_t> clamped_lines;      ///< the first ten of them
  std::map<std::string, std::size_t> skipped;  ///< lines left out, by tag
};

/// Reads a graph. The error names path:line and what was expected: wrong field count or numbers, an id twice or never
/// defined, a 2-D graph.
Result<G2oGraph> read_g2o(const std::filesystem::path& path);

/// The same from a stream; `name` stands for the path in errors.
Result<G2oGraph> parse_g2o(std::istream& in, const std::string& name);

/// Poses (ids 0, 1, … or as given, one per pose), FIX for poses with a prior, and between factors. Losses and all other
/// factors have no g2o form.
std::string g2o_text(const graph::Graph& graph, std::span<const std::int64_t> ids = {});

/// The key poses as the optimum has them, odometry as edges between them with its noise, and the objects as comment
/// lines `# object ID TYPE x y z qx qy qz qw [sizes]`, which g2o's readers skip. What moved the poses to the optimum,
/// contacts and seats, has no g2o form.
std::string g2o_text(const MapSnapshot& map);

/// Σ eᵀΩe over the between factors with the translation and the quaternion's vector part, losses left out: the figure
/// that pose-graph benchmarks quote.
double g2o_cost(const graph::Graph& graph);

}  // namespace kinemap
