// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/graph/graph.hpp"

namespace kinemap {

/// What a choice of sides costs, in squared standard deviations where no unit is given. The noise is wide: it is what a
/// bent contour departs from a rectangle by, not the noise of a contact.
struct SideCosts {
  double sigma_m = 0.08;             ///< of the distance from a side, and beyond its ends
  double angle_rad = 0.5;            ///< of the angle between the travel and the side
  double off = 9.0;                  ///< of a contact on no side
  double leave = 2.0;                ///< to leave the contour, and to come back to it
  double corner = 2.0;               ///< to go on to the next side
  double back = 8.0;                 ///< to turn back round a corner; twice: to jump to the opposite side
  double hysteresis = 1.0;           ///< bonus of the side that a contact had
  double corner_clear_m = 0.04;      ///< contacts so near to the end of a side are in the corner, …
  double corner_clear_share = 0.12;  ///< … but no more than this part of the side
};

/// One contact in the axes of a rectangle, for the choice of its side.
struct SideQuery {
  Eigen::Vector2d p;                       ///< from the centre, along u and v, m
  Eigen::Vector2d travel;                  ///< unit direction in which the hand moves there; zero: unknown
  graph::Edge before = graph::Edge::None;  ///< the side it had until now
};

/// The sides on which a hand that goes round a rectangle touched it: the cheapest sequence over all contacts (Viterbi).
/// A contact costs by its distance from the side and by the angle between its travel and the side; from one side the
/// hand goes on to the next one round the contour, in one sense; turning back or jumping across costs more, and so does
/// leaving the contour. With `hysteresis`, a contact keeps the side it had unless another one is clearly better.
///
/// `size` along u and v, m; `allowed` for MinusU, PlusU, MinusV, PlusV. Edge::None where the hand was on no side.
/// Deterministic; time grows with the number of contacts.
std::vector<graph::Edge> choose_sides(std::span<const SideQuery> contacts, const std::array<double, 2>& size,
                                      const std::array<bool, 4>& allowed, const SideCosts& price, bool hysteresis);

/// Distance from `p` to the line of the side, signed outward from the centre of the axes, m.
double side_error(const Eigen::Vector2d& p, const std::array<double, 2>& size, graph::Edge side);

/// Distance from `p` to the side between its corners, m; the side goes on where the next one is not `drawn`.
double distance_from_side(const Eigen::Vector2d& p, const std::array<double, 2>& size, const std::array<bool, 4>& drawn,
                          graph::Edge side);

/// Whether `p`, on `side`, lies so near to one of its ends that the corner, which people cut, pulls it inwards. Where
/// the next side was not `drawn` there is no corner.
bool in_corner(const Eigen::Vector2d& p, const std::array<double, 2>& size, const std::array<bool, 4>& drawn,
               graph::Edge side, const SideCosts& price);

/// Unit direction of travel at each point, from its neighbours within `half_window_m` of path on both sides; zero where
/// the hand dwells.
std::vector<Eigen::Vector2d> travel_directions(std::span<const Eigen::Vector2d> points, double half_window_m);

}  // namespace kinemap
