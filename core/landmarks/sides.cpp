// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/sides.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinemap {
namespace {

using graph::Edge;

// Counter-clockwise round the rectangle.
constexpr std::array<Edge, 4> kRound{Edge::PlusU, Edge::PlusV, Edge::MinusU, Edge::MinusV};

bool is_u(Edge e) { return e == Edge::MinusU || e == Edge::PlusU; }
bool is_plus(Edge e) { return e == Edge::PlusU || e == Edge::PlusV; }

// The hand is at a place of the contour (an index into kRound) and on it or off it: place + 4 when off.
constexpr std::size_t kStates = 8;
using Costs = std::array<double, kStates>;

double squared(double x) { return x * x; }

/// The side that `side` meets at the end where `along` lies.
Edge next_side(Edge side, double along) {
  if (is_u(side)) return along < 0.0 ? Edge::MinusV : Edge::PlusV;
  return along < 0.0 ? Edge::MinusU : Edge::PlusU;
}

/// How far `p` is beyond the nearer end of the side, m. Where the next side was not drawn the contour is open: nobody
/// knows yet where this one ends.
double beyond_end(const Eigen::Vector2d& p, const std::array<double, 2>& size, const std::array<bool, 4>& drawn,
                  Edge side) {
  const double along = is_u(side) ? p.y() : p.x();
  const bool open = !drawn[static_cast<std::size_t>(next_side(side, along)) - 1];
  return open ? 0.0 : std::max(0.0, std::abs(along) - 0.5 * size[is_u(side) ? 1 : 0]);
}

/// What it costs to say that the contact lies on this side, in squared standard deviations.
double contact_cost(const SideQuery& contact, const std::array<double, 2>& size, const std::array<bool, 4>& allowed,
                    Edge side, const SideCosts& price) {
  const double across = side_error(contact.p, size, side), beyond = beyond_end(contact.p, size, allowed, side);
  const double parallel = is_u(side) ? std::abs(contact.travel.y()) : std::abs(contact.travel.x());
  const double angle = contact.travel.isZero() ? 0.0 : std::acos(std::min(1.0, parallel));
  const double kept = contact.before == side ? price.hysteresis : 0.0;
  return squared(across / price.sigma_m) + squared(beyond / price.sigma_m) + squared(angle / price.angle_rad) - kept;
}

Costs contact_costs(const SideQuery& contact, const std::array<double, 2>& size, const std::array<bool, 4>& allowed,
                    const SideCosts& price) {
  Costs out;
  for (std::size_t k = 0; k < 4; ++k) {
    const Edge side = kRound[k];
    out[k] = allowed[static_cast<std::size_t>(side) - 1] ? contact_cost(contact, size, allowed, side, price) : HUGE_VAL;
    out[k + 4] = price.off - (contact.before == Edge::None ? price.hysteresis : 0.0);
  }
  return out;
}

/// From one place to the next: on along the same side, round the corner, back round it, or across.
double step_cost(std::size_t from, std::size_t to, bool forward, const SideCosts& price) {
  const std::size_t turn = (to + 4 - from) % 4;  // the places only: 4 is a whole turn
  const double off = (from < 4) != (to < 4) ? price.leave : 0.0;
  if (turn == 0) return off;
  if (turn == 2) return off + 2.0 * price.back;
  return off + ((turn == 1) == forward ? price.corner : price.back);
}

struct Path {
  std::vector<Edge> sides;
  double cost = HUGE_VAL;
};

Path cheapest(const std::vector<Costs>& costs, bool forward, const SideCosts& price) {
  std::array<Costs, kStates> steps;  // to, from
  for (std::size_t to = 0; to < kStates; ++to)
    for (std::size_t from = 0; from < kStates; ++from) steps[to][from] = step_cost(from, to, forward, price);
  std::vector<std::array<std::uint8_t, kStates>> came(costs.size());
  Costs best = costs.front();
  for (std::size_t i = 1; i < costs.size(); ++i) {
    Costs next;
    for (std::size_t to = 0; to < kStates; ++to) {
      double least = HUGE_VAL;
      for (std::size_t from = 0; from < kStates; ++from) {
        const double cost = best[from] + steps[to][from];
        if (cost < least) least = cost, came[i][to] = static_cast<std::uint8_t>(from);
      }
      next[to] = least + costs[i][to];
    }
    best = next;
  }
  auto at = static_cast<std::size_t>(std::min_element(best.begin(), best.end()) - best.begin());
  Path path{std::vector<Edge>(costs.size(), Edge::None), best[at]};
  for (std::size_t i = costs.size(); i-- > 0; at = came[i][at])
    if (at < 4) path.sides[i] = kRound[at];
  return path;
}

}  // namespace

double side_error(const Eigen::Vector2d& p, const std::array<double, 2>& size, Edge side) {
  return (is_plus(side) ? -0.5 : 0.5) * size[is_u(side) ? 0 : 1] + (is_u(side) ? p.x() : p.y());
}

double distance_from_side(const Eigen::Vector2d& p, const std::array<double, 2>& size, const std::array<bool, 4>& drawn,
                          Edge side) {
  return std::hypot(side_error(p, size, side), beyond_end(p, size, drawn, side));
}

bool in_corner(const Eigen::Vector2d& p, const std::array<double, 2>& size, const std::array<bool, 4>& drawn, Edge side,
               const SideCosts& price) {
  const double along = is_u(side) ? p.y() : p.x(), length = size[is_u(side) ? 1 : 0];
  const double clear = std::min(price.corner_clear_m, price.corner_clear_share * length);
  return std::abs(along) > 0.5 * length - clear && drawn[static_cast<std::size_t>(next_side(side, along)) - 1];
}

std::vector<Edge> choose_sides(std::span<const SideQuery> contacts, const std::array<double, 2>& size,
                               const std::array<bool, 4>& allowed, const SideCosts& price, bool hysteresis) {
  if (contacts.empty()) return {};
  SideCosts used = price;
  if (!hysteresis) used.hysteresis = 0.0;
  std::vector<Costs> costs;
  costs.reserve(contacts.size());
  for (const SideQuery& contact : contacts) costs.push_back(contact_costs(contact, size, allowed, used));
  Path one = cheapest(costs, true, used), other = cheapest(costs, false, used);
  return other.cost < one.cost ? std::move(other.sides) : std::move(one.sides);
}

std::vector<Eigen::Vector2d> travel_directions(std::span<const Eigen::Vector2d> points, double half_window_m) {
  const std::size_t n = points.size();
  std::vector<Eigen::Vector2d> out(n, Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t a = i, b = i;
    while (a > 0 && (points[a] - points[i]).norm() < half_window_m) --a;
    while (b + 1 < n && (points[b] - points[i]).norm() < half_window_m) ++b;
    const Eigen::Vector2d d = points[b] - points[a];
    if (d.norm() > 0.5 * half_window_m) out[i] = d.normalized();
  }
  return out;
}

}  // namespace kinemap
