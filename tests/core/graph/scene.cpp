// SPDX-License-Identifier: Apache-2.0
#include "tests/core/graph/scene.hpp"

#include <cmath>

namespace kinemap::graph::test {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

class Builder {
 public:
  explicit Builder(const SceneOptions& options) : o_(options), random_(options.seed) {}

  Scene build() {
    variables();
    trajectory_factors();
    contacts();
    landmark_factors();
    headings();
    return std::move(scene_);
  }

 private:
  double n(double sigma) { return o_.noise == 0.0 ? 0.0 : random_.normal(o_.noise * sigma); }
  Vector3d n3(double sigma) { return {n(sigma), n(sigma), n(sigma)}; }

  void variables() {
    for (std::size_t i = 0; i < o_.poses; ++i) {  // twice round a circle of 1.5 m
      const double a = 4.0 * kPi * static_cast<double>(i) / static_cast<double>(o_.poses);
      const Pose level = level_pose({2.0 + 1.5 * std::cos(a), 2.0 + 1.5 * std::sin(a), 0.95}, a + kPi / 2.0);
      g_.poses.push_back({level.p, (level.q * random_.rotation(0.2)).normalized()});
    }
    g_.landmarks = {{LandmarkKind::Wall, {kPi, 0.1}, {4.2, 2.0, 1.0}, true},
                    {LandmarkKind::Wall, {kPi / 2.0, -0.05}, {2.0, -0.1, 1.0}, true},
                    {LandmarkKind::Table, {2.0, 2.1, 0.72, 0.4, 1.4, 0.7}, Vector3d::Zero(), true},
                    {LandmarkKind::Screen, {0.0, 2.0, 1.3, 0.1, 0.9, 0.5, 0.08}, Vector3d::Zero(), true},
                    {LandmarkKind::Seat, {2.2, 1.2, 0.45, 1.0}, Vector3d::Zero(), true}};
    g_.touch_points = {{{0.03, -0.18, 0.01}, {0.03, -0.18, 0.01}, Vector3d::Constant(0.02), false, 2.0},
                       {{0.0, -0.09, 0.0}, {0.0, -0.09, 0.0}, Vector3d::Constant(0.02), true}};
  }

  void trajectory_factors() {
    for (std::size_t i = 0; i < o_.poses; ++i) {
      const Pose& T = g_.poses[i];
      if (i > 0) {
        BetweenFactor f{i - 1, i, g_.poses[i - 1].inverse() * T, Matrix6::Identity(), o_.loss};
        f.T_i_j = {f.T_i_j.p + n3(0.01), (f.T_i_j.q * so3_exp(n3(0.005))).normalized()};
        f.sqrt_information.diagonal() << 100.0, 100.0, 100.0, 200.0, 200.0, 200.0;
        f.sqrt_information(0, 5) = 20.0;  // sideways and heading errors go together
        g_.between.push_back(f);
      }
      g_.gravity.push_back({i, (so3_exp(n3(0.01)) * (T.q.conjugate() * Vector3d::UnitZ())).normalized(), 0.01});
      g_.floors.push_back({i, T.inverse() * Vector3d(T.p.x(), T.p.y() + 0.1, n(0.02)), 0.0, 0.02, o_.loss});
    }
    if (!o_.prior) return;
    PriorFactor prior{0, g_.poses[0], Matrix6::Identity() * 1000.0};
    g_.priors.push_back(prior);
  }

  void contact(std::size_t i, std::size_t landmark, const Vector3d& p_landmark, Edge edge, Edge corner) {
    ContactFactor f;
    f.i = i, f.landmark = landmark, f.touch = (i + landmark) % 2, f.edge = edge, f.corner = corner, f.loss = o_.loss;
    const Vector3d p_map = landmark_pose(g_.landmarks[landmark]) * (p_landmark + n3(0.02));
    const Eigen::Quaterniond q = random_.rotation();
    f.T_i_hand = {g_.poses[i].inverse() * p_map - q * g_.touch_points[f.touch].p_hand, q};
    g_.contacts.push_back(f);
  }

  void contacts() {
    for (std::size_t i = 0; i < o_.poses; ++i) {
      for (int k = 0; k < 2; ++k) {
        contact(i, Scene::kWallA, {random_.uniform(-1.0, 1.0), random_.uniform(-0.5, 0.5), 0.0}, Edge::None,
                Edge::None);
        contact(i, Scene::kWallB, {random_.uniform(-1.0, 1.0), random_.uniform(-0.5, 0.5), 0.0}, Edge::None,
                Edge::None);
      }
      for (const std::size_t l : {Scene::kTable, Scene::kScreen}) {
        const double a = g_.landmarks[l].x[4] / 2.0, b = g_.landmarks[l].x[5] / 2.0;
        contact(i, l, {-a, random_.uniform(-b, b), 0.0}, Edge::MinusU, Edge::None);
        contact(i, l, {a, random_.uniform(-b, b), 0.0}, Edge::PlusU, Edge::None);
        contact(i, l, {random_.uniform(-a, a), -b, 0.0}, Edge::MinusV, Edge::None);
        contact(i, l, {random_.uniform(-a, a), b, 0.0}, Edge::PlusV, Edge::None);
        contact(i, l, {-a, b, 0.0}, Edge::MinusU, Edge::PlusV);
        contact(i, l, {a, -b, 0.0}, Edge::None, Edge::PlusU);
        contact(i, l, {random_.uniform(-a, a), random_.uniform(-b, b), 0.0}, Edge::None, Edge::None);
      }
    }
  }

  void landmark_factors() {
    const Pose seat = landmark_pose(g_.landmarks[Scene::kSeat]);
    for (std::size_t i = 0; i < o_.poses; i += 7) {
      SeatFactor f{i, Scene::kSeat, g_.poses[i].inverse() * seat, 0.05, 0.03, 0.1, o_.loss};
      f.T_i_seat = {f.T_i_seat.p + n3(0.03), (f.T_i_seat.q * so3_exp(n3(0.05))).normalized()};
      g_.seats.push_back(f);
    }
    g_.parallels.push_back({Scene::kWallA, Scene::kWallB, -kPi / 2.0, 0.02, o_.loss});
    g_.landmark_priors.push_back({Scene::kScreen, 6, 0.08, 0.05});
  }

  /// A suit whose north is elsewhere and turns: scalar 0 is the rate, 1 and 2 the norths of the two rounds.
  void headings() {
    constexpr double kRate = 0.002, kSeconds = 30.0;
    g_.scalars = {kRate, 0.4, 0.4 + kRate * kSeconds};
    const auto north = [&](std::size_t i) { return i < o_.poses / 2 ? std::size_t{1} : std::size_t{2}; };
    const auto suit = [&](std::size_t i, std::size_t north_of) {
      return (level_pose(Eigen::Vector3d::Zero(), n(0.02) - g_.scalars[north_of]).q * g_.poses[i].q).normalized();
    };
    for (std::size_t i = 0; i < o_.poses; ++i) {
      const std::size_t k = north(i), before = i > 0 ? i - 1 : 0;
      g_.compasses.push_back({before, i, k, suit(before, k), suit(i, k), i > 0 ? 0.9 : 0.0, 0.02});
    }
    g_.drifts.push_back({1, 2, 0, kSeconds, 0.05});
    g_.scalar_priors.push_back({0, kRate, 0.01});
  }

  SceneOptions o_;
  Random random_;
  Scene scene_;
  Graph& g_ = scene_.truth;
};

}  // namespace

Scene make_scene(const SceneOptions& options) { return Builder(options).build(); }

Graph perturbed(const Graph& graph, double size, unsigned seed) {
  Random random(seed);
  Graph out = graph;
  for (Pose& T : out.poses) {
    Eigen::Matrix<double, 6, 1> d;
    d << random.vector(size), random.vector(size);
    T = plus(T, d);
  }
  for (Landmark& l : out.landmarks) {
    for (int k = 0; k < dimension(l.kind); ++k) l.x[static_cast<std::size_t>(k)] += random.uniform(-size, size);
  }
  for (TouchPoint& t : out.touch_points) {
    if (!t.fixed) t.p_hand += random.vector(0.2 * size);
  }
  for (double& x : out.scalars) x += random.uniform(-size, size);
  return out;
}

Graph moved(const Graph& graph, double yaw, const Vector3d& shift) {
  const Pose T = level_pose(shift, yaw);
  Graph out = graph;
  for (Pose& p : out.poses) p = T * p;
  for (PriorFactor& f : out.priors) f.T_map_i = T * f.T_map_i;
  for (std::size_t k = 1; k < out.scalars.size(); ++k) out.scalars[k] += yaw;
  for (FloorFactor& f : out.floors) f.z += shift.z();
  for (Landmark& l : out.landmarks) {
    l.x[l.kind == LandmarkKind::Wall ? 0 : 3] += yaw;
    if (l.kind == LandmarkKind::Wall) {
      l.anchor = T * l.anchor;
    } else {
      Eigen::Map<Vector3d> centre(l.x.data());
      centre = T * Vector3d(centre);
    }
  }
  return out;
}

}  // namespace kinemap::graph::test
