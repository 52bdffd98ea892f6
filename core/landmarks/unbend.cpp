// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/unbend.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kMostTurn = 0.6;       // rad: what metal turns the heading by
constexpr double kMostRate = 0.06;      // rad/s: the same over its shortest time constant
constexpr double kUsualRate = 0.02;     // rad/s: standard deviation beside metal
constexpr double kStep = 0.005;         // rad/s between the rates that are tried
constexpr double kSigma = 0.03;         // m: the arm's error, …
constexpr double kCorrelation = 2.0;    // s: … which is one and the same so long
constexpr double kClearlyBetter = 4.0;  // 2 ln of the odds that the heading turned

Eigen::Vector3d turned(const Eigen::Vector3d& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

}  // namespace

std::vector<TracePoint> unbent(std::span<const TracePoint> points, double rate) {
  std::vector<TracePoint> out(points.begin(), points.end());
  if (points.empty() || rate == 0.0) return out;
  const std::size_t middle = points.size() / 2;
  const auto angle = [&](std::size_t i) { return -rate * (points[i].time_s - points[middle].time_s); };
  const auto place = [&](std::size_t i, std::size_t from) {
    out[i].p_body = out[from].p_body + turned(points[i].p_body - points[from].p_body, 0.5 * (angle(i) + angle(from)));
    out[i].p = out[i].p_body + turned(points[i].p - points[i].p_body, angle(i));
  };
  for (std::size_t i = middle + 1; i < points.size(); ++i) place(i, i - 1);
  for (std::size_t i = middle; i-- > 0;) place(i, i + 1);
  return out;
}

double heading_rate(std::span<const TracePoint> points,
                    const std::function<double(std::span<const TracePoint>)>& misfit) {
  const double duration = points.back().time_s - points.front().time_s;
  const double most = std::min(kMostRate, kMostTurn / std::max(1.0, duration));
  const double independent = (1.0 + duration / kCorrelation) / (kSigma * kSigma);
  double best = 0.0;
  const double straight = independent * misfit(points);
  double least = std::isfinite(straight) ? straight - kClearlyBetter : HUGE_VAL;
  for (double rate = -most; rate <= most; rate += kStep) {
    const double cost = independent * misfit(unbent(points, rate)) + (rate / kUsualRate) * (rate / kUsualRate);
    if (cost < least) least = cost, best = rate;
  }
  return best;
}

}  // namespace kinemap
