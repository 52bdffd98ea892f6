// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/observe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kinemap {
namespace {

using graph::ContactFactor;
using graph::Edge;
using graph::LandmarkKind;

constexpr double kHandTurns = 0.2;      // rad: people draw with the hand at one angle to the surface ...
constexpr double kThen = 2.0;           // s: ... for so long at least
constexpr double kWhileTurning = 10.0;  // × the noise of a contact that tells where a side ends all the same
constexpr double kLongestTurn = 1.5;    // s, of the hand on its way to the surface or from it

/// Indices [begin, end) into observation.contacts without those at either end in which the hand still turns to the
/// surface, or turns away already. They are near it, but not on it, and nothing else turns the hand so far: a few of
/// them would tell wrongly where along the hand it touches.
IndexRange without_turns(const Observation& observation, const Trace& trace, const graph::Graph& graph) {
  const auto& contacts = observation.contacts;
  std::vector<double> angle;
  for (const std::size_t k : contacts)
    angle.push_back(std::asin(std::clamp(fingers_into(observation.landmark, trace.contacts[k], graph), -1.0, 1.0)));
  const auto time = [&](std::ptrdiff_t k) { return trace.contacts[contacts[static_cast<std::size_t>(k)]].time_s; };
  const auto n = static_cast<std::ptrdiff_t>(contacts.size());
  // How many from `first` on, by `step`, are at another angle than those right after.
  const auto turning = [&](std::ptrdiff_t first, std::ptrdiff_t step) {
    for (std::ptrdiff_t k = first;; k += step) {
      std::vector<double> after;
      for (std::ptrdiff_t m = k + step; m >= 0 && m < n && std::abs(time(m) - time(k)) < kThen; m += step)
        after.push_back(angle[static_cast<std::size_t>(m)]);
      if (after.empty() || std::abs(time(k) - time(first)) > kLongestTurn ||
          std::abs(angle[static_cast<std::size_t>(k)] - median(std::move(after))) < kHandTurns)
        return static_cast<std::size_t>(std::abs(k - first));
    }
  };
  if (contacts.empty()) return {0, 0};
  const std::size_t front = turning(0, 1), back = turning(n - 1, -1);
  return front + back < contacts.size() ? IndexRange{front, contacts.size() - back} : IndexRange{0, contacts.size()};
}

/// Indices into observation.contacts, thinned by distance; contacts in corners and contacts without a side are treated
/// as they are: the former always kept, the latter left out for rectangles, of which they would only pull on the plane.
/// `lying`: where the hand does not turn; where a side ends it may.
std::vector<std::size_t> thinned(const Observation& observation, const std::vector<TracePoint>& points,
                                 IndexRange lying, double spacing) {
  const bool rectangle = observation.landmark.kind != LandmarkKind::Wall;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < observation.contacts.size(); ++k) {
    if (rectangle && observation.labels[k].edge == Edge::None) continue;
    const bool corner = observation.labels[k].corner != Edge::None;
    if (!corner && (k < lying.begin || k >= lying.end)) continue;
    const auto& p = points[observation.contacts[k]].p;
    if (corner || kept.empty() || (p - points[observation.contacts[kept.back()]].p).norm() >= spacing)
      kept.push_back(k);
  }
  return kept;
}

/// Distance to which the contacts of an observation are thinned, m: the short sides of a small screen are to keep
/// enough of them for the robust loss to tell which ones strayed.
double spacing_of(const graph::Landmark& landmark, double usual) {
  constexpr double kOnShortestSide = 12.0;
  if (landmark.kind == LandmarkKind::Wall) return usual;
  return std::min(usual, std::min(landmark.x[4], landmark.x[5]) / kOnShortestSide);
}

/// Factor by which the noise of single contacts grows so that contacts on one side within the correlation time count as
/// one.
std::array<double, 5> inflation(const Observation& observation, const std::vector<TracePoint>& points,
                                const std::vector<std::size_t>& kept, double spacing, double correlation_s) {
  std::array<double, 5> count{}, duration{};
  for (std::size_t n = 0; n < kept.size(); ++n) {
    const auto side = static_cast<std::size_t>(observation.labels[kept[n]].edge);
    count[side] += 1.0;
    if (n == 0) continue;
    const auto& now = points[observation.contacts[kept[n]]];
    const auto& before = points[observation.contacts[kept[n - 1]]];
    if ((now.p - before.p).norm() < 4.0 * spacing) duration[side] += now.time_s - before.time_s;
  }
  std::array<double, 5> out{};
  for (std::size_t side = 0; side < 5; ++side)
    out[side] = std::sqrt(std::max(1.0, count[side] / (1.0 + duration[side] / correlation_s)));
  return out;
}

void append_landmark(const graph::Landmark& landmark, double begin_s, double end_s, double floor_z, MapState& state) {
  state.graph.landmarks.push_back(landmark);
  state.landmarks.push_back(LandmarkRecord{0, 1, begin_s, end_s, floor_z});
}

}  // namespace

std::vector<TracePoint> trace_points(const Trace& trace, const graph::Graph& graph, std::size_t touch) {
  std::vector<TracePoint> points;
  points.reserve(trace.contacts.size());
  for (const auto& contact : trace.contacts) {
    const Pose& T_map_key = graph.poses[contact.key_pose];
    points.push_back(
        {contact.time_s, T_map_key * (contact.T_key_hand * graph.touch_points[touch].p_hand), T_map_key.p});
  }
  return points;
}

double fingers_into(const graph::Landmark& landmark, const HandContact& contact, const graph::Graph& graph) {
  const double heading = landmark.x[landmark.kind == LandmarkKind::Wall ? 0 : 3];
  const Eigen::Vector3d normal = landmark.kind == LandmarkKind::Table
                                     ? Eigen::Vector3d::UnitZ()
                                     : Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
  return -normal.dot(graph.poses[contact.key_pose].q * (contact.T_key_hand.q * -Eigen::Vector3d::UnitY()));
}

std::size_t add_observation(const Observation& observation, const Trace& trace, const std::vector<TracePoint>& points,
                            std::size_t touch, double floor_z, const MapperConfig& config, MapState& state) {
  const std::size_t landmark = state.graph.landmarks.size();
  const double begin_s = points[observation.contacts.front()].time_s,
               end_s = points[observation.contacts.back()].time_s;
  append_landmark(observation.landmark, begin_s, end_s, floor_z, state);
  if (observation.landmark.kind == LandmarkKind::Screen)
    state.graph.landmark_priors.push_back({landmark, 6, 0.0, config.odometry.tilt_rad});
  if (observation.landmark.kind !=
      LandmarkKind::Wall)  // no side may be left undetermined, whatever the robust weights do
    for (const int side : {4, 5})
      state.graph.landmark_priors.push_back(
          {landmark, side, observation.landmark.x[static_cast<std::size_t>(side)], 1.0});

  const double spacing = spacing_of(observation.landmark, config.hand.contact_spacing_m);
  const IndexRange lying = without_turns(observation, trace, state.graph);
  const auto kept = thinned(observation, points, lying, spacing);
  const auto wider = inflation(observation, points, kept, spacing, config.hand.contact_correlation_s);
  ObservationRecord record{landmark, 0, state.graph.contacts.size(), kept.size(), 0, begin_s, end_s};
  for (const std::size_t k : kept) {
    const HandContact& contact = trace.contacts[observation.contacts[k]];
    const SideLabel label = observation.labels[k];
    const bool turning = k < lying.begin || k >= lying.end;
    const double factor_of_side = wider[static_cast<std::size_t>(label.edge)] * (turning ? kWhileTurning : 1.0);
    ContactFactor factor;
    factor.i = contact.key_pose;
    factor.landmark = landmark;
    factor.touch = touch;
    factor.T_i_hand = contact.T_key_hand;
    factor.edge = label.edge;
    factor.corner = label.corner;
    factor.sigma_plane_m = factor.sigma_edge_m = config.hand.contact_sigma_m * factor_of_side;
    factor.share = 1.0 / (factor_of_side * factor_of_side);
    factor.sigma_corner_m = config.hand.corner_sigma_m;
    factor.loss = {graph::Loss::Kind::Cauchy, config.hand.loss_scale};
    state.graph.contacts.push_back(factor);
  }
  if (!kept.empty()) record.key_pose = trace.contacts[observation.contacts[kept[kept.size() / 2]]].key_pose;
  state.observations.push_back(record);
  state.summary.contacts += kept.size();
  return landmark;
}

std::size_t add_seat(const Sitting& sitting, double floor_z, const MapperConfig& config, MapState& state) {
  const std::size_t landmark = state.graph.landmarks.size();
  const Pose T_map_seat = state.graph.poses[sitting.key_pose] * sitting.T_key_seat;
  graph::Landmark seat;
  seat.kind = LandmarkKind::Seat;
  seat.x = {T_map_seat.p.x(), T_map_seat.p.y(), T_map_seat.p.z(), heading_of(T_map_seat.q), 0.0, 0.0, 0.0};
  append_landmark(seat, sitting.begin_s, sitting.end_s, floor_z, state);
  graph::SeatFactor factor;
  factor.i = sitting.key_pose;
  factor.landmark = landmark;
  factor.T_i_seat = sitting.T_key_seat;
  factor.sigma_level_m = std::hypot(config.seats.level_sigma_m, sitting.spread_m);
  factor.sigma_z_m = config.seats.height_sigma_m;
  factor.sigma_heading_rad = config.seats.heading_sigma_rad;
  factor.loss = {graph::Loss::Kind::Cauchy, config.seats.loss_scale};
  state.observations.push_back(
      {landmark, sitting.key_pose, 0, 0, state.graph.seats.size(), sitting.begin_s, sitting.end_s});
  state.graph.seats.push_back(factor);
  return landmark;
}

}  // namespace kinemap
