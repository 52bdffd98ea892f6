// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/geometry.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/pose.hpp"

namespace kinemap {

std::optional<PlaneFit> fit_plane(std::span<const Eigen::Vector3d> points, double min_spread_m) {
  if (points.size() < 3) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::Matrix3Xd centred(3, n);
  for (Eigen::Index i = 0; i < n; ++i) centred.col(i) = points[static_cast<std::size_t>(i)];
  const Eigen::Vector3d centroid = centred.rowwise().mean();
  centred.colwise() -= centroid;
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(centred, Eigen::ComputeThinU);
  const Eigen::Vector3d extent = svd.singularValues() / std::sqrt(static_cast<double>(n));
  if (!(extent[1] > min_spread_m)) return std::nullopt;
  const Eigen::Vector3d normal = svd.matrixU().col(2);
  return PlaneFit{normal, normal.dot(centroid), centroid, extent};
}

std::optional<LineFit> fit_line(std::span<const Eigen::Vector2d> points) {
  if (points.size() < 2) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
  scatter /= static_cast<double>(points.size());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(scatter);
  if (!(eigen.eigenvalues()[1] > 1e-12)) return std::nullopt;
  return LineFit{mean, eigen.eigenvectors().col(1), std::sqrt(std::max(0.0, eigen.eigenvalues()[0]))};
}

namespace {

std::vector<Eigen::Vector2d> within(std::span<const Eigen::Vector2d> points, const LineFit& line, double tolerance) {
  std::vector<Eigen::Vector2d> inliers;
  for (const auto& p : points)
    if (std::abs(line.distance(p)) <= tolerance) inliers.push_back(p);
  return inliers;
}

}  // namespace

std::optional<LineFit> fit_line_robust(std::span<const Eigen::Vector2d> points, double tolerance_m) {
  if (points.size() < 2) return std::nullopt;
  // Pairs out of up to 24 evenly spaced points: enough for traces, of which at least a third lies on the line.
  constexpr std::size_t kSamples = 24;
  const std::size_t samples = std::min(kSamples, points.size());
  const auto sample = [&](std::size_t k) {
    return points[k * (points.size() - 1) / std::max<std::size_t>(1, samples - 1)];
  };
  std::optional<LineFit> best;
  double best_score = 0.0;
  for (std::size_t a = 0; a < samples; ++a) {
    for (std::size_t b = a + 1; b < samples; ++b) {
      const Eigen::Vector2d chord = sample(b) - sample(a);
      if (chord.norm() < 3.0 * tolerance_m) continue;
      const LineFit line{sample(a), chord.normalized(), 0.0};
      double score = 0.0;  // truncated quadratic: counts inliers, prefers the tighter of two equal counts
      for (const auto& p : points) {
        const double r = line.distance(p) / tolerance_m;
        score += std::max(0.0, 1.0 - r * r);
      }
      if (score > best_score) best_score = score, best = line;
    }
  }
  if (!best) return std::nullopt;
  for (int round = 0; round < 3; ++round) {
    const auto refined = fit_line(within(points, *best, tolerance_m));
    if (!refined) break;
    best = refined;
  }
  return best;
}

double winding(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& centre) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d a = points[i - 1] - centre, b = points[i] - centre;
    sum += wrap_angle(std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x()));
  }
  return sum;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace kinemap
