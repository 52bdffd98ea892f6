// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace kinemap {

/// A plane with the spread of the points it was fitted to; n·p = offset.
struct PlaneFit {
  Eigen::Vector3d normal;    ///< unit
  double offset = 0.0;       ///< m
  Eigen::Vector3d centroid;  ///< m
  Eigen::Vector3d
      extent;  ///< standard deviations along the principal axes, longest first, m; the third is the residual
};

/// Least-squares plane by singular value decomposition of the centred points (paper, section IV). nullopt for fewer
/// than three points and for points that leave a direction open (coincident or collinear: second extent below
/// `min_spread_m`).
std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points, double min_spread_m = 1e-6);

/// A line in the plane with the spread of its points.
struct LineFit {
  Eigen::Vector2d point;      ///< centroid, m
  Eigen::Vector2d direction;  ///< unit
  double rms = 0.0;           ///< of the distances, m

  [[nodiscard]] Eigen::Vector2d normal() const { return {-direction.y(), direction.x()}; }
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const { return normal().dot(p - point); }
  [[nodiscard]] double along(const Eigen::Vector2d& p) const { return direction.dot(p - point); }
};

/// Total least squares. nullopt for fewer than two points or coincident ones.
std::optional<LineFit> fit_line(std::span<const Eigen::Vector2d> points);

/// The line with most points within `tolerance_m`, refined on those; the samples are taken in a fixed pattern, so equal
/// input gives equal output.
std::optional<LineFit> fit_line_robust(std::span<const Eigen::Vector2d> points, double tolerance_m);

/// Indices [begin, end).
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

/// Angle swept by the direction from `centre` to the points, in order, rad: ±2π for one closed contour round it.
double winding(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& centre);

/// Median of the values (the upper of the two middle ones); 0 for none.
double median(std::vector<double> values);

}  // namespace kinemap
