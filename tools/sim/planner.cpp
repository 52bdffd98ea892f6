// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/planner.hpp"

#include <queue>

namespace kinemap::sim {

namespace {

/// Cuts the corners of a polyline (Chaikin), ends kept.
std::vector<Vec2> rounded(const std::vector<Vec2>& points) {
  std::vector<Vec2> out{points.front()};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (i > 0) out.push_back(points[i] * 0.75 + points[i + 1] * 0.25);
    if (i + 2 < points.size()) out.push_back(points[i] * 0.25 + points[i + 1] * 0.75);
  }
  out.push_back(points.back());
  return out;
}

std::vector<Vec2> resampled(const std::vector<Vec2>& points, double step) {
  std::vector<Vec2> out{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 d = points[i] - points[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(d.norm() / step)));
    for (int k = 1; k <= pieces; ++k) out.push_back(points[i - 1] + d * (static_cast<double>(k) / pieces));
  }
  return out;
}

}  // namespace

Planner::Planner(const Building& building) : building_(building) {
  Vec2 low(1e9, 1e9), high(-1e9, -1e9);
  for (const auto& room : building.rooms) {
    for (const auto& p : room.polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  origin_ = low;
  nx_ = static_cast<int>((high.x() - low.x()) / kStep) + 1;
  ny_ = static_cast<int>((high.y() - low.y()) / kStep) + 1;
  clearance_.resize(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
  for (int y = 0; y < ny_; ++y) {
    for (int x = 0; x < nx_; ++x)
      clearance_[index_of({x, y})] = static_cast<float>(building.clearance(point_of({x, y})));
  }
}

Planner::Cell Planner::cell_of(const Vec2& p) const {
  const Vec2 g = (p - origin_) / kStep;
  return {std::clamp(static_cast<int>(std::lround(g.x())), 0, nx_ - 1),
          std::clamp(static_cast<int>(std::lround(g.y())), 0, ny_ - 1)};
}

bool Planner::nearest_free(Cell& c) const {
  const Cell at = c;
  double best = 1e9;
  for (int y = std::max(0, at.y - 10); y <= std::min(ny_ - 1, at.y + 10); ++y) {
    for (int x = std::max(0, at.x - 10); x <= std::min(nx_ - 1, at.x + 10); ++x) {
      const double d = std::hypot(x - at.x, y - at.y);
      if (d < best && clearance_[index_of({x, y})] >= kBody) {
        best = d;
        c = {x, y};
      }
    }
  }
  return best < 1e9;
}

std::vector<Vec2> Planner::search(Cell from, Cell to) const {
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<double> cost(clearance_.size(), 1e18);
  std::vector<std::size_t> parent(clearance_.size(), clearance_.size());
  const auto remaining = [&](Cell c) { return std::hypot(c.x - to.x, c.y - to.y); };
  cost[index_of(from)] = 0.0;
  open.emplace(remaining(from), index_of(from));
  std::vector<bool> closed(clearance_.size(), false);
  while (!open.empty()) {
    const std::size_t index = open.top().second;
    open.pop();
    if (closed[index]) continue;
    closed[index] = true;
    if (index == index_of(to)) break;
    const Cell c{static_cast<int>(index) % nx_, static_cast<int>(index) / nx_};
    for (int k = 0; k < 9; ++k) {
      const Cell n{c.x + k % 3 - 1, c.y + k / 3 - 1};
      if (n.x < 0 || n.y < 0 || n.x >= nx_ || n.y >= ny_) continue;
      const double clear = clearance_[index_of(n)];
      if (clear < kBody) continue;
      const double tight = std::max(0.0, kComfort - clear) / (kComfort - kBody);
      const double next = cost[index] + std::hypot(n.x - c.x, n.y - c.y) * (1.0 + 2.0 * tight);
      if (next < cost[index_of(n)]) {
        cost[index_of(n)] = next;
        parent[index_of(n)] = index;
        open.emplace(next + remaining(n), index_of(n));
      }
    }
  }
  std::vector<Vec2> points;
  if (!closed[index_of(to)]) return points;
  for (std::size_t i = index_of(to); i < parent.size(); i = parent[i]) {
    points.push_back(point_of({static_cast<int>(i) % nx_, static_cast<int>(i) / nx_}));
  }
  std::reverse(points.begin(), points.end());
  return points;
}

bool Planner::straight_is_clear(const Vec2& a, const Vec2& b) const {
  const int pieces = std::max(1, static_cast<int>((b - a).norm() / 0.06));
  // Never nearer than the ends' own clearance or the comfortable one, whichever is less.
  const double least = std::max(0.20, std::min({kComfort - 0.1, clearance(a), clearance(b)}));
  for (int i = 1; i < pieces; ++i) {
    const Vec2 p = a + (b - a) * (static_cast<double>(i) / pieces);
    const bool leaving = std::min((p - a).norm(), (p - b).norm()) < 0.15;  // ends may be nearer to things
    if (clearance(p) < (leaving ? std::min(least, 0.15) : least) - 1e-3) return false;
  }
  return true;
}

std::vector<Vec2> Planner::way(const Vec2& from, const Vec2& to) const {
  if ((to - from).norm() < 1e-6) return {from, to};
  if (straight_is_clear(from, to)) return resampled({from, to}, 0.05);
  Cell a = cell_of(from), b = cell_of(to);
  if (!nearest_free(a) || !nearest_free(b)) return {};
  auto points = search(a, b);
  if (points.empty()) return {};
  points.front() = from;
  points.back() = to;
  std::vector<Vec2> pulled{points.front()};
  for (std::size_t i = 0; i + 1 < points.size();) {
    std::size_t far = i + 1;
    for (std::size_t j = std::min(points.size() - 1, i + 60); j > i + 1; --j) {
      if (straight_is_clear(points[i], points[j])) {
        far = j;
        break;
      }
    }
    pulled.push_back(points[far]);
    i = far;
  }
  const auto dense = resampled(pulled, 0.30);
  return resampled(rounded(rounded(rounded(dense))), 0.05);
}

Vec2 Planner::pushed_clear(Vec2 p, const Vec2& inside, double margin) const {
  constexpr double kProbe = 0.01;
  for (int i = 0; i < 50 && clearance(p) < 0.03; ++i) p += (inside - p) * 0.1;
  for (int i = 0; i < 40; ++i) {
    const double here = clearance(p);
    if (here >= margin) break;
    const Vec2 slope(clearance(p + Vec2(kProbe, 0)) - clearance(p - Vec2(kProbe, 0)),
                     clearance(p + Vec2(0, kProbe)) - clearance(p - Vec2(0, kProbe)));
    if (slope.norm() < 1e-9) break;
    p += slope.normalized() * std::min(0.02, margin - here + 1e-3);
  }
  return p;
}

}  // namespace kinemap::sim
