// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/wire/result.hpp"
#include "tools/kinemap/association.hpp"
#include "tools/kinemap/consistency.hpp"
#include "tools/kinemap/topology.hpp"
#include "tools/kinemap/truth.hpp"

/// How good a map is against the truth, by the measures of the paper (section VI). Uses no code of the estimator, only
/// its value types.
namespace kinemap::eval {

/// Mean and standard deviation (n − 1) over what was measured.
struct Spread {
  std::size_t n = 0;
  double mean = 0.0, std = 0.0, median = 0.0, max = 0.0;
};
Spread spread_of(std::vector<double> values);

/// A true object and the object of the map that stands for it.
struct Match {
  std::uint32_t truth_id = 0;
  std::uint32_t object_id = 0;
  Class klass = Class::Wall;
  std::vector<double> edges_m;  ///< as the map has them, those that are judged
  std::vector<double>
      edge_errors_percent;  ///< |estimate − truth| / truth of each edge; a wall's length only (its height is assumed)
  double level_error_m = 0.0;      ///< centre, in the plane of the floor, after the alignment; walls: across the wall
  double height_error_m = 0.0;     ///< centre z, signed
  double heading_error_rad = 0.0;  ///< ≥ 0; tables modulo 90°
  NormalisedErrors normalised;

  [[nodiscard]] double mape_percent() const;  ///< mean of edge_errors_percent
};

struct ClassCounts {
  std::size_t truth = 0;       ///< objects that the wearer touched or sat on
  std::size_t found = 0;       ///< of those, with an object in the map
  std::size_t estimated = 0;   ///< objects of the map; a screen without a match counts by its own size
  std::size_t duplicates = 0;  ///< second objects for what had been found
};

struct Evaluation {
  std::array<ClassCounts, kClassCount> counts{};
  std::vector<Match> matches;
  std::vector<std::uint32_t> missed;    ///< truth ids
  std::vector<std::uint32_t> spurious;  ///< map ids without a true object near them (duplicates not included)
  std::vector<std::uint32_t> duplicates;
  std::size_t poses = 0;
  double rmse_open_loop_m = 0.0;  ///< the suit's own key poses, after their own alignment
  double rmse_optimised_m = 0.0;
  double scale = 1.0;  ///< true over optimised extent of the trajectory; see scale_between
  Pose T_truth_map;    ///< least squares over the trajectory
  Pose T_truth_start;  ///< the map brought onto the truth at its first pose, where its sigmas are zero
  AssociationCheck association;
  TopologyCheck topology;
};

/// Compares. Needs at least two trajectory poses inside the truth's time; else an Error.
Result<Evaluation> evaluate(const MapSnapshot& map, const Truth& truth);

/// Figures over one or several sessions: errors pooled over all matches, RMSE over sessions.
struct Report {
  struct PerClass {
    ClassCounts counts;
    Spread mape_percent;  ///< over objects
    Spread level_error_m;
    Spread heading_error_rad;
    NormalisedErrors normalised;  ///< of all matches
  };
  std::size_t sessions = 0;
  std::array<PerClass, kClassCount> classes;
  ClassCounts total;
  AssociationCounts association;
  std::size_t topology_right = 0;  ///< sessions
  Spread rmse_open_loop_m, rmse_optimised_m;
};
Report summarise(const std::vector<Evaluation>& sessions);

/// 1 when there was nothing to find.
double recall(const ClassCounts& counts);
/// 1 when nothing was claimed.
double precision(const ClassCounts& counts);

nlohmann::ordered_json to_json(const Report& report);
nlohmann::ordered_json to_json(const Evaluation& evaluation);
/// Tables for people, with lines of Markdown.
std::string to_markdown(const Report& report);
std::string consistency_markdown(const Report& report);
std::string association_markdown(const Report& report);

}  // namespace kinemap::eval
