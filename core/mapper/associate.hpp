// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/graph/marginals.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {

/// A landmark that the newcomer may be.
struct Candidate {
  std::size_t landmark = 0;
  int quarter_turns = 0;  ///< tables: the newcomer's axes are turned so many times 90° against the candidate's
  double distance = 0.0;  ///< Mahalanobis distance squared of the relative marginal covariance
  int dimensions = 0;     ///< of that distance
  double evidence = 0.0;  ///< 2 ln of the odds that both are one, against another object of the kind
};

/// Accepted landmarks of the same kind that `newcomer` is compatible with, most evidence first: the difference of their
/// numbers is judged by the joint marginal covariance of both (drift between the visits included) plus what two traces
/// of one object differ by anyway, against the density of other objects that look the same.
std::vector<Candidate> candidates(const MapState& state, std::size_t newcomer, const graph::Marginals& marginals,
                                  const MapperConfig::Association& config);

/// Makes `from` one with `candidate.landmark`: its factors refer to that landmark now, `from` becomes inactive.
void merge(MapState& state, std::size_t from, const Candidate& candidate);

/// Gives visit `visit` of `state.observations` a landmark of its own again, with the numbers of the one that it was
/// merged into, and returns it. The visit must not be the landmark's only one.
std::size_t split(MapState& state, std::size_t visit);

/// Variance of the way from pose j to pose i along the level unit vector `axis`, m².
double variance_along(const MapState& state, const graph::Marginals& marginals, std::size_t i, std::size_t j,
                      const Eigen::Vector3d& axis);

/// Whether visit `visit` of `state.observations` is to a wall that its other visits touched along another stretch, so
/// that it would be no candidate for it now: walls of two rooms that continue each other, and drift has been corrected.
bool touched_elsewhere(const MapState& state, std::size_t visit);

/// Whether two tables, screens or seats would stand in one and the same place, which two things cannot: most of the
/// smaller one is within the other.
bool in_one_place(const graph::Landmark& a, const graph::Landmark& b);

/// Squared Mahalanobis distance that `dimensions` numbers exceed as rarely as one number exceeds `sigma`
/// (Wilson–Hilferty).
double gate(double sigma, int dimensions);

/// First and last coordinate of a wall's contacts along it (axis ẑ × n from the anchor), those on its plane; m.
struct Interval {
  double lo = 0.0, hi = 0.0;
};
std::optional<Interval> contact_interval(const MapState& state, std::size_t wall);
/// The same of one visit, along the wall with the given frame.
std::optional<Interval> contact_interval(const MapState& state, const ObservationRecord& visit, const WallFrame& frame);
/// Where along the wall it lies on its contacts are (of what is settled: the ends), m.
std::vector<double> contacts_along(const MapState& state, const ObservationRecord& visit, const WallFrame& frame);

}  // namespace kinemap
