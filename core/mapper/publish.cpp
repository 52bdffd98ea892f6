// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/publish.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

std::array<Eigen::Vector3d, 4> corners_of(const Pose& T_map_rectangle, double length_u, double length_v) {
  const double u = 0.5 * length_u, v = 0.5 * length_v;
  return {T_map_rectangle * Eigen::Vector3d(-u, -v, 0.0), T_map_rectangle * Eigen::Vector3d(u, -v, 0.0),
          T_map_rectangle * Eigen::Vector3d(u, v, 0.0), T_map_rectangle * Eigen::Vector3d(-u, v, 0.0)};
}

PlaneEquation plane_through(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) { return {normal, normal.dot(p)}; }

/// Frame of an upright surface: +x its normal, +z up in it.
Eigen::Quaterniond upright_orientation(const Eigen::Vector3d& normal, const Eigen::Vector3d& up) {
  Eigen::Matrix3d r;
  r << normal, up.cross(normal), up;
  return Eigen::Quaterniond(r).normalized();
}

double sigma_of(const Eigen::MatrixXd& covariance, Eigen::Index k) {
  return std::sqrt(std::max(0.0, covariance(k, k)));
}

Eigen::MatrixXd covariance_of(const graph::Marginals& marginals, std::span<const std::size_t> landmarks) {
  std::vector<graph::Variable> variables;
  for (const std::size_t k : landmarks) variables.push_back({graph::Variable::Kind::Landmark, k});
  return marginals.joint(variables);
}

/// What the scale of the way, which no closure sees, adds to the sigma of something so far from the first pose, per
/// axis.
double with_scale(double sigma, double distance, double scale_sigma) {
  return std::sqrt(sigma * sigma + 0.5 * std::pow(scale_sigma * distance, 2));
}

/// Position, heading and the two sizes of a table, screen or seat; `heading` is the index of the heading among the
/// numbers.
void set_sigma(MapObject& object, const Eigen::MatrixXd& covariance, bool swapped) {
  object.sigma.position_m = std::sqrt(std::max(0.0, covariance.topLeftCorner<2, 2>().trace() / 2.0));
  object.sigma.heading_rad = sigma_of(covariance, 3);
  if (covariance.rows() < 6) return;
  object.sigma.size_m = {sigma_of(covariance, 4), sigma_of(covariance, 5)};
  if (swapped) std::swap(object.sigma.size_m[0], object.sigma.size_m[1]);
}

void describe_table(const Landmark& landmark, MapObject& object) {
  const bool swapped = landmark.x[5] > landmark.x[4];  // +x along the long side
  const double heading = landmark.x[3] + (swapped ? std::numbers::pi / 2.0 : 0.0);
  // A table looks the same from both ends: the heading is given within half a turn.
  const double half_turn = std::remainder(heading, std::numbers::pi);
  object.type = ObjectType::Table;
  object.functions = {"place"};
  object.pose = level_pose({landmark.x[0], landmark.x[1], landmark.x[2]}, half_turn);
  object.size = {std::max(landmark.x[4], landmark.x[5]), std::min(landmark.x[4], landmark.x[5])};
  object.corners = corners_of(object.pose, (*object.size)[0], (*object.size)[1]);
  object.plane = plane_through(object.pose.p, Eigen::Vector3d::UnitZ());
}

void describe_screen(const Landmark& landmark, MapObject& object) {
  const Pose T_map_rectangle = graph::landmark_pose(landmark);
  const Eigen::Vector3d normal = T_map_rectangle.q * Eigen::Vector3d::UnitZ();
  object.type = ObjectType::Screen;
  object.functions = {"view"};
  object.pose = {T_map_rectangle.p, upright_orientation(normal, T_map_rectangle.q * Eigen::Vector3d::UnitY())};
  object.size = {std::max(landmark.x[4], landmark.x[5]), std::min(landmark.x[4], landmark.x[5])};
  object.corners = corners_of(T_map_rectangle, landmark.x[4], landmark.x[5]);
  object.plane = plane_through(object.pose.p, normal);
}

void describe_seat(const Landmark& landmark, MapObject& object) {
  object.type = ObjectType::Chair;
  object.functions = {"sit"};
  object.pose = level_pose({landmark.x[0], landmark.x[1], landmark.x[2]}, landmark.x[3]);
}

void describe_wall(const MapState& state, const FiniteWall& wall, const MapperConfig& config, MapObject& object) {
  const WallFrame frame(state.graph.landmarks[wall.landmark]);
  const double floor_z = state.landmarks[wall.landmark].floor_z, height = config.walls.height_m;
  const auto at = [&](double s, double z) {
    const Eigen::Vector3d p = frame.point(s);
    return Eigen::Vector3d(p.x(), p.y(), z);
  };
  object.type = ObjectType::Wall;
  object.functions = {"bound"};
  object.pose = {at(0.5 * (wall.tail.s + wall.head.s), floor_z + 0.5 * height),
                 upright_orientation(frame.normal, Eigen::Vector3d::UnitZ())};
  object.size = {wall.length(), height};
  object.height_assumed = true;
  object.ends = {wall.tail.kind, wall.head.kind};
  object.corners = {at(wall.tail.s, floor_z), at(wall.head.s, floor_z), at(wall.head.s, floor_z + height),
                    at(wall.tail.s, floor_z + height)};
  object.plane = plane_through(object.pose.p, frame.normal);
}

/// Where the head of wall `a` meets wall `b`, along `a`.
double meeting(const Landmark& a, const Landmark& b) {
  const WallFrame fa(a), fb(b);
  const double slope = fb.normal.dot(fa.axis);
  return std::abs(slope) < 1e-9 ? 0.0 : -fb.distance(fa.origin) / slope;
}

/// The length of a wall depends on the walls that it meets too; an end that meets none adds what is not known of it.
void set_wall_sigma(const MapState& state, const std::vector<FiniteWall>& walls, const FiniteWall& wall,
                    const graph::Marginals& marginals, double scale_sigma, MapObject& object) {
  std::vector<std::size_t> involved{wall.landmark};
  const auto meets = [&](const WallEnd& end) -> std::optional<std::size_t> {
    if (end.kind != EndKind::Corner) return std::nullopt;
    const std::size_t landmark = walls[*end.neighbour].landmark;
    const auto at = std::find(involved.begin(), involved.end(), landmark);
    const auto index = static_cast<std::size_t>(at - involved.begin());
    if (at == involved.end()) involved.push_back(landmark);
    return index;
  };
  const auto at_tail = meets(wall.tail), at_head = meets(wall.head);
  std::vector<Landmark> values;
  for (const std::size_t k : involved) values.push_back(state.graph.landmarks[k]);
  const auto length = [&](const std::vector<Landmark>& x) {
    const double tail = at_tail ? meeting(x[0], x[*at_tail]) : wall.tail.s;
    const double head = at_head ? meeting(x[0], x[*at_head]) : wall.head.s;
    return head - tail;
  };
  const auto n = static_cast<Eigen::Index>(2 * values.size());
  Eigen::RowVectorXd j(n);
  constexpr double kStep = 1e-6;
  for (Eigen::Index k = 0; k < n; ++k) {
    auto plus = values, minus = values;
    plus[static_cast<std::size_t>(k / 2)].x[static_cast<std::size_t>(k % 2)] += kStep;
    minus[static_cast<std::size_t>(k / 2)].x[static_cast<std::size_t>(k % 2)] -= kStep;
    j[k] = (length(plus) - length(minus)) / (2.0 * kStep);
  }
  const Eigen::MatrixXd covariance = covariance_of(marginals, involved);
  double variance = (j * covariance * j.transpose())(0, 0);
  for (const WallEnd& end : {wall.tail, wall.head}) variance += end.sigma_m * end.sigma_m;
  variance += std::pow(scale_sigma * wall.length(), 2);
  object.sigma.size_m = {std::sqrt(std::max(0.0, variance)), 0.0};
  object.sigma.heading_rad = sigma_of(covariance, 0);
  object.sigma.position_m = sigma_of(covariance, 1);
}

/// The wall's other stretches were seen too; it keeps the id that it had first.
void add_record(const LandmarkRecord& record, MapObject& object) {
  object.id = std::min(object.id, record.id);
  object.observations += record.observations;
  object.first_seen_s = std::min(object.first_seen_s, record.first_seen_s);
  object.last_seen_s = std::max(object.last_seen_s, record.last_seen_s);
}

void add_visits(const MapState& state, std::size_t landmark, MapObject& object) {
  for (const ObservationRecord& visit : state.observations)
    if (visit.landmark == landmark) object.visits.push_back({visit.begin_s, visit.end_s});
}

}  // namespace

std::vector<MapObject> map_objects(const MapState& state, const std::vector<FiniteWall>& walls,
                                   const graph::Marginals* marginals, const MapperConfig& config) {
  const double scale_sigma = config.odometry.scale_sigma * state.graph.noise.way;
  std::vector<MapObject> objects;
  for (std::size_t k = 0; k < state.graph.landmarks.size(); ++k) {
    const Landmark& landmark = state.graph.landmarks[k];
    const LandmarkRecord& record = state.landmarks[k];
    if (!landmark.active || record.id == 0) continue;
    MapObject object;
    object.id = record.id;
    object.observations = record.observations;
    object.first_seen_s = record.first_seen_s;
    object.last_seen_s = record.last_seen_s;
    add_visits(state, k, object);
    const std::array<std::size_t, 1> self{k};
    if (landmark.kind == LandmarkKind::Wall) {
      const auto wall = std::find_if(walls.begin(), walls.end(), [k](const FiniteWall& w) { return w.landmark == k; });
      if (wall == walls.end()) continue;
      describe_wall(state, *wall, config, object);
      for (const std::size_t other : wall->stretches) {
        if (other == k) continue;
        add_record(state.landmarks[other], object);
        add_visits(state, other, object);
      }
      if (marginals) set_wall_sigma(state, walls, *wall, *marginals, scale_sigma, object);
    } else {
      if (landmark.kind == LandmarkKind::Table) describe_table(landmark, object);
      if (landmark.kind == LandmarkKind::Screen) describe_screen(landmark, object);
      if (landmark.kind == LandmarkKind::Seat) describe_seat(landmark, object);
      if (marginals) set_sigma(object, covariance_of(*marginals, self), landmark.x[5] > landmark.x[4]);
    }
    std::sort(object.visits.begin(), object.visits.end(),
              [](const Visit& a, const Visit& b) { return a.begin_s < b.begin_s; });
    if (marginals) {
      const double away = (object.pose.p - state.graph.poses.front().p).head<2>().norm();
      object.sigma.position_m = with_scale(object.sigma.position_m, away, scale_sigma);
    }
    objects.push_back(std::move(object));
  }
  std::sort(objects.begin(), objects.end(), [](const MapObject& a, const MapObject& b) { return a.id < b.id; });
  return objects;
}

}  // namespace kinemap
