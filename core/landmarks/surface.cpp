// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/landmarks/geometry.hpp"

namespace kinemap {
namespace {

/// Speed of the hand at each point over a window of ±0.1 s, m/s.
std::vector<double> speeds(std::span<const TracePoint> points) {
  std::vector<double> v(points.size(), 0.0);
  std::size_t a = 0, b = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (points[i].time_s - points[a].time_s > 0.1 && a + 1 < i) ++a;
    while (b + 1 < points.size() && points[b].time_s - points[i].time_s < 0.1) ++b;
    const double dt = points[b].time_s - points[a].time_s;
    if (dt > 1e-3) v[i] = (points[b].p - points[a].p).norm() / dt;
  }
  return v;
}

/// Number of points at the front that belong to the reach. `time(i)` and `v(i)` count from the end that is looked at.
template <class Time, class Speed>
std::size_t reach_length(std::size_t n, const Time& time, const Speed& v, double threshold, double max_s) {
  std::size_t last_fast = 0;
  bool any = false;
  for (std::size_t i = 0; i < n / 2 && time(i) <= max_s; ++i)
    if (v(i) > threshold) last_fast = i, any = true;
  if (!any) return 0;
  // The reach ends where the hand comes to rest on the surface: the next minimum of its speed.
  std::size_t i = last_fast + 1;
  while (i + 1 < n / 2 && time(i) - time(last_fast) < 0.5 && v(i + 1) < v(i)) ++i;
  return i;
}

/// The longest run in time of inliers, where a lift-off of up to 1.5 s or 0.3 m does not end it.
std::vector<std::size_t> longest_run(std::span<const TracePoint> points, const std::vector<bool>& inlier) {
  std::vector<std::size_t> best, run;
  double best_length = -1.0, length = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!inlier[i]) continue;
    if (!run.empty()) {
      const double step = (points[i].p - points[run.back()].p).norm();
      const bool goes_on = i == run.back() + 1 || (points[i].time_s - points[run.back()].time_s < 1.5 && step < 0.5);
      if (!goes_on)
        run.clear(), length = 0.0;
      else
        length += step;
    }
    run.push_back(i);
    if (length > best_length) best_length = length, best = run;
  }
  return best;
}

double path_length(std::span<const TracePoint> points, const std::vector<std::size_t>& members) {
  double sum = 0.0;
  for (std::size_t k = 1; k < members.size(); ++k)
    if (members[k] == members[k - 1] + 1) sum += (points[members[k]].p - points[members[k - 1]].p).norm();
  return sum;
}

std::vector<Eigen::Vector2d> level(std::span<const TracePoint> points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const auto& point : points) out.emplace_back(point.p.head<2>());
  return out;
}

/// Robust standard deviation of the middle of the trace from the surface; its ends may be on their way.
double spread_of(std::span<const double> distances) {
  const std::size_t n = distances.size();
  std::vector<double> middle;
  for (std::size_t i = n / 6; i < n - n / 6; ++i) middle.push_back(std::abs(distances[i]));
  return 1.48 * median(std::move(middle));
}

/// How far from a surface a contact may lie: the arm errs for seconds, in one suit little, in another much.
double tolerance_for(double spread, const LandmarkConfig& config) {
  return std::clamp(3.0 * spread, 0.5 * config.plane_tolerance_m, 2.0 * config.plane_tolerance_m);
}

std::vector<bool> within(std::span<const double> distances, double tolerance) {
  std::vector<bool> inlier(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) inlier[i] = std::abs(distances[i]) <= tolerance;
  return inlier;
}

std::optional<Surface> upright_surface(std::span<const TracePoint> points, const LandmarkConfig& config) {
  const auto flat = level(points);
  auto line = fit_line_robust(flat, config.plane_tolerance_m);
  if (!line) return std::nullopt;
  std::vector<double> distances(points.size());
  const auto measure = [&] {
    for (std::size_t i = 0; i < flat.size(); ++i) distances[i] = line->distance(flat[i]);
    return spread_of(distances);
  };
  double tolerance = tolerance_for(measure(), config);
  double lo = 0.0, hi = 0.0;
  for (const auto& p : flat) {
    if (std::abs(line->distance(p)) > tolerance) continue;
    lo = std::min(lo, line->along(p)), hi = std::max(hi, line->along(p));
  }
  tolerance += config.plane_tolerance_per_m * (hi - lo);
  if (const auto again = fit_line_robust(flat, tolerance)) line = again;
  Surface surface{Surface::Kind::Upright, {}, 0.0, measure(), 0.0, {}};
  surface.members = longest_run(points, within(distances, tolerance));
  if (surface.members.size() < 3) return std::nullopt;
  Eigen::Vector2d normal = line->normal();
  double side = 0.0;
  for (const std::size_t i : surface.members) side += line->distance(points[i].p_body.head<2>());
  if (side < 0.0) normal = -normal;
  surface.normal = {normal.x(), normal.y(), 0.0};
  surface.offset = normal.dot(line->point);
  return surface;
}

/// A straight level line is no level surface: it may as well be a wall traced at one height.
bool is_straight(std::span<const Eigen::Vector2d> flat, double tolerance) {
  const auto line = fit_line_robust(flat, tolerance);
  const auto off = std::count_if(flat.begin(), flat.end(), [&](const Eigen::Vector2d& p) {
    return line && std::abs(line->distance(p)) > 2.0 * tolerance;
  });
  return static_cast<double>(off) < 0.1 * static_cast<double>(flat.size());
}

std::optional<Surface> level_surface(std::span<const TracePoint> points, const LandmarkConfig& config) {
  // The height that most points share, by the same truncated quadratic score as the lines.
  double best_z = 0.0, best_score = -1.0;
  for (const auto& candidate : points) {
    double score = 0.0;
    for (const auto& point : points) {
      const double r = (point.p.z() - candidate.p.z()) / config.plane_tolerance_m;
      score += std::max(0.0, 1.0 - r * r);
    }
    if (score > best_score) best_score = score, best_z = candidate.p.z();
  }
  std::vector<double> distances(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) distances[i] = points[i].p.z() - best_z;
  Surface surface{Surface::Kind::Level, Eigen::Vector3d::UnitZ(), 0.0, spread_of(distances), 0.0, {}};
  surface.members = longest_run(points, within(distances, tolerance_for(surface.spread, config)));
  if (surface.members.size() < 3) return std::nullopt;
  std::vector<double> heights;
  std::vector<Eigen::Vector2d> flat;
  for (const std::size_t i : surface.members)
    heights.push_back(points[i].p.z()), flat.emplace_back(points[i].p.head<2>());
  surface.offset = median(heights);
  if (is_straight(flat, config.plane_tolerance_m)) return std::nullopt;
  return surface;
}

/// The surface with its share of the trace, if that is half of it.
std::optional<Surface> holding_half(std::span<const TracePoint> points, std::optional<Surface> surface) {
  if (!surface) return surface;
  std::vector<std::size_t> all(points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  surface->share = path_length(points, surface->members) / std::max(1e-9, path_length(points, all));
  if (surface->share < 0.5) surface.reset();
  return surface;
}

}  // namespace

IndexRange without_reach(std::span<const TracePoint> points, const LandmarkConfig& config) {
  const std::size_t n = points.size();
  if (n < 8) return {0, n};
  const auto v = speeds(points);
  const double usual =
      median({v.begin() + static_cast<std::ptrdiff_t>(n / 5), v.end() - static_cast<std::ptrdiff_t>(n / 5)});
  const double threshold = std::max(config.reach_speed_m_per_s, 2.0 * usual);
  const double first = points.front().time_s, last = points.back().time_s;
  // In a short trace a fast stroke in the middle is not far from either end.
  const double longest = std::min(config.reach_max_s, 0.3 * (last - first));
  const std::size_t front = reach_length(
      n, [&](std::size_t i) { return points[i].time_s - first; }, [&](std::size_t i) { return v[i]; }, threshold,
      longest);
  const std::size_t back = reach_length(
      n, [&](std::size_t i) { return last - points[n - 1 - i].time_s; }, [&](std::size_t i) { return v[n - 1 - i]; },
      threshold, longest);
  return {front, n - back};
}

std::optional<Surface> find_upright_surface(std::span<const TracePoint> points, const LandmarkConfig& config) {
  return holding_half(points, upright_surface(points, config));
}

std::vector<Surface> find_surfaces(std::span<const TracePoint> points, const LandmarkConfig& config) {
  std::vector<Surface> out;
  if (auto surface = find_upright_surface(points, config)) out.push_back(*surface);
  if (auto surface = holding_half(points, level_surface(points, config))) out.push_back(*surface);
  // One that holds clearly more of the trace; else the one from which it strays less.
  if (out.size() == 2) {
    const bool alike = std::abs(out[0].share - out[1].share) < 0.1 * std::max(out[0].share, out[1].share);
    if (alike ? out[1].spread < out[0].spread : out[1].share > out[0].share) std::swap(out[0], out[1]);
  }
  return out;
}

}  // namespace kinemap
