// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/ideal.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "tools/sim/session.hpp"

namespace kinemap::bench {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kEvery = 0.1;          // s between the contacts that are used
constexpr double kOnSide = 0.03;        // m: a hand farther from each side is in a corner that was cut, or lifted
constexpr std::size_t kOnEachSide = 4;  // contacts at least
constexpr double kRound = 0.005;        // m: standard deviation of what is not modelled
constexpr double kArm_s = 3.0, kUnrest_s = 1.5, kMetal_s = 20.0;  // correlation of the suit's errors
constexpr double kDrawn = 0.5;  // metal draws a sensor so far on the way to where it draws it in the end

/// A screen or table; its frame has x along the first edge and y along the second.
struct Rectangle {
  sim::Placed T_map_rectangle;
  std::array<double, 2> size;
};

/// One contact, with what its error depends on.
struct Contact {
  double time_s = 0.0;
  int side = -1;                       ///< 0, 1: at ±half of the first edge; 2, 3: of the second
  Vector2d at = Vector2d::Zero();      ///< where it was, in the rectangle
  Vector3d normal = Vector3d::Zero();  ///< of the side, in the map
  Vector3d tip = Vector3d::Zero(), pelvis = Vector3d::Zero();  ///< in the map, as they were
  std::array<Vector3d, 3> joints{};                            ///< shoulder, elbow, wrist
  double off_true_way = 0.0, off_suit_way = 0.0;               ///< m across the side: reported less true
};

double yaw_of(const sim::Quat& q) { return sim::heading_of((q * Vector3d::UnitX()).head<2>()); }

std::map<int, Rectangle> rectangles_of(const sim::Session& session) {
  std::map<int, Rectangle> out;
  for (const auto& table : session.building().tables)
    out[table.id] = {{session.to_map(sim::lift(table.top.centre, table.height)),
                      sim::about_z(session.heading_to_map(table.top.heading))},
                     {2.0 * table.top.half.x(), 2.0 * table.top.half.y()}};
  for (const auto& screen : session.building().screens) {
    Eigen::Matrix3d axes;
    const Vector3d normal = sim::lift(sim::direction(session.heading_to_map(screen.heading)), 0.0);
    axes << Vector3d::UnitZ().cross(normal), Vector3d::UnitZ(), normal;
    out[screen.id] = {{session.to_map(screen.centre), sim::Quat(axes)}, {screen.width, screen.height}};
  }
  return out;
}

bool in_contact(const sim::Interval& interval, double time_s) {
  if (time_s < interval.contact_begin_s || time_s > interval.contact_end_s) return false;
  for (const auto& [from, to] : interval.lift_offs)
    if (time_s >= from && time_s <= to) return false;
  return true;
}

/// The suit's place and heading when a gesture began: odometry is counted from there.
struct Start {
  sim::Placed truth, reported;
};

std::optional<Contact> contact_of(const sim::Sample& sample, const Start& start, const Rectangle& rectangle,
                                  const Vector3d& p_hand_touch) {
  const sim::Placed &T_true = sample.truth[sim::kPelvis], &T_suit = sample.reported[sim::kPelvis],
                    &T_hand = sample.reported[sim::kRightHand];
  const auto local = [&](const Vector3d& p) -> Vector3d {
    return rectangle.T_map_rectangle.q.conjugate() * (p - rectangle.T_map_rectangle.p);
  };
  const std::array<double, 4> sides{0.5 * rectangle.size[0], -0.5 * rectangle.size[0], 0.5 * rectangle.size[1],
                                    -0.5 * rectangle.size[1]};
  const Vector3d truth = local(sample.p_map_touch);
  Contact contact;
  double nearest = kOnSide;
  for (int k = 0; k < 4; ++k) {
    const double off = std::abs(truth[k / 2] - sides[static_cast<std::size_t>(k)]);
    if (off < nearest) nearest = off, contact.side = k;
  }
  if (contact.side < 0) return std::nullopt;
  const Vector3d tip = T_hand.p + T_hand.q * p_hand_touch;
  const Vector3d by_true_way = T_true.p + T_true.q * (T_suit.q.conjugate() * (tip - T_suit.p));
  const sim::Quat turn = sim::about_z(yaw_of(start.truth.q) - yaw_of(start.reported.q));
  const Vector3d by_suit_way = start.truth.p + turn * (tip - start.reported.p);
  const int axis = contact.side / 2;
  const double side = sides[static_cast<std::size_t>(contact.side)];
  contact.time_s = sample.time_s;
  contact.at = truth.head<2>();
  contact.normal = rectangle.T_map_rectangle.q * Vector3d::Unit(axis);
  contact.tip = sample.p_map_touch;
  contact.pelvis = T_true.p;
  for (std::size_t k = 0; k < 3; ++k) contact.joints[k] = sample.truth[sim::kRightUpperArm + k].p;
  contact.off_true_way = local(by_true_way)[axis] - side;
  contact.off_suit_way = local(by_suit_way)[axis] - side;
  return contact;
}

/// How far a contact moves across its side when what lies between it and `pivot` turns by 1 rad about z, m.
double turned(const Contact& contact, const Vector3d& pivot) { return (contact.tip - pivot).cross(contact.normal).z(); }

/// Of first order from rest at 0: what metal does to the heading of a sensor.
double metal(double variance, double t, double s) {
  return variance * (std::exp(-std::abs(t - s) / kMetal_s) - std::exp(-(t + s) / kMetal_s));
}

/// Covariance of the arm's errors.
MatrixXd arm_covariance(const std::vector<Contact>& contacts, const sim::DriftColumn& column) {
  const double joint = std::pow(sim::radians(column.arm_deg), 2) / 3.0,
               unrest = std::pow(column.jitter_slow_m, 2) / 3.0, white = std::pow(column.jitter_white_m, 2) / 3.0,
               pull = std::pow(kDrawn * sim::radians(column.magnetic_deg), 2);
  const auto n = static_cast<Eigen::Index>(contacts.size());
  MatrixXd c(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const Contact& p = contacts[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < n; ++b) {
      const Contact& q = contacts[static_cast<std::size_t>(b)];
      const double apart = std::abs(p.time_s - q.time_s);
      double levers = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        levers += (p.tip - p.joints[k]).cross(p.normal).dot((q.tip - q.joints[k]).cross(q.normal));
      c(a, b) = joint * levers * std::exp(-apart / kArm_s) +
                unrest * p.normal.dot(q.normal) * std::exp(-apart / kUnrest_s) +
                pull * turned(p, p.joints[0]) * turned(q, q.joints[0]) * std::exp(-apart / kMetal_s);
    }
    c(a, a) += white + kRound * kRound;
  }
  return c;
}

/// Covariance of what odometry adds from the first contact on.
MatrixXd way_covariance(const std::vector<Contact>& contacts, const sim::DriftColumn& column) {
  const auto n = static_cast<Eigen::Index>(contacts.size());
  const auto at = [&](Eigen::Index k) -> const Contact& { return contacts[static_cast<std::size_t>(k)]; };
  const double bias = sim::radians(column.heading_bias_deg_min) / 60.0,
               walk = sim::radians(column.heading_walk_deg_sqrt_min) / std::sqrt(60.0),
               pull = std::pow(kDrawn * sim::radians(column.magnetic_deg), 2), begin = at(0).time_s;
  // Each step of the heading turns all that comes after it about where the wearer was.
  MatrixXd response = MatrixXd::Zero(n, n), steps = MatrixXd::Zero(n, n);
  VectorXd walked = VectorXd::Zero(n);
  for (Eigen::Index k = 1; k < n; ++k) {
    walked[k] = walked[k - 1] + (at(k).pelvis - at(k - 1).pelvis).head<2>().norm();
    for (Eigen::Index a = k; a < n; ++a) response(a, k) = turned(at(a), at(k - 1).pelvis);
    const double t = at(k).time_s - begin, t0 = at(k - 1).time_s - begin;
    steps(k, k) += walk * walk * (t - t0);
    for (Eigen::Index l = 1; l < n; ++l) {
      const double s = at(l).time_s - begin, s0 = at(l - 1).time_s - begin;
      steps(k, l) += bias * bias * (t - t0) * (s - s0) + metal(pull, t, s) - metal(pull, t0, s) - metal(pull, t, s0) +
                     metal(pull, t0, s0);
    }
  }
  MatrixXd c = response * steps * response.transpose();
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b)
      c(a, b) +=
          at(a).normal.dot(at(b).normal) * std::pow(column.walk_m_per_sqrt_m, 2) * std::min(walked[a], walked[b]) +
          std::pow(column.step_scale, 2) * at(a).normal.dot(at(a).pelvis - at(0).pelvis) *
              at(b).normal.dot(at(b).pelvis - at(0).pelvis);
  return c;
}

/// Errors of the two edges and their information, summed over visits.
struct Edges {
  Matrix2d information = Matrix2d::Zero();
  Vector2d weighted = Vector2d::Zero();

  /// Generalised least squares for place, heading and both edges, of which the edges count.
  void add(const std::vector<Contact>& contacts, const MatrixXd& covariance, const VectorXd& off) {
    MatrixXd design(off.size(), 5);
    for (Eigen::Index k = 0; k < off.size(); ++k) {
      const Contact& c = contacts[static_cast<std::size_t>(k)];
      const double half = c.side % 2 == 0 ? 0.5 : -0.5;
      if (c.side < 2)
        design.row(k) << 1.0, 0.0, -c.at.y(), half, 0.0;
      else
        design.row(k) << 0.0, 1.0, c.at.x(), 0.0, half;
    }
    const MatrixXd weighted_design = covariance.llt().solve(design);
    const Eigen::Matrix<double, 5, 5> all = (design.transpose() * weighted_design).inverse();
    const Eigen::Matrix<double, 5, 1> found = all * (weighted_design.transpose() * off);
    const Matrix2d visit = all.bottomRightCorner<2, 2>().inverse();
    information += visit;
    weighted += visit * found.tail<2>();
  }

  [[nodiscard]] double percent(const std::array<double, 2>& size) const {
    const Vector2d error = information.ldlt().solve(weighted);
    return 50.0 * (std::abs(error[0]) / size[0] + std::abs(error[1]) / size[1]);
  }
};

bool all_round(const std::vector<Contact>& contacts) {
  std::array<std::size_t, 4> count{};
  for (const Contact& contact : contacts) ++count[static_cast<std::size_t>(contact.side)];
  return std::ranges::all_of(count, [](std::size_t n) { return n >= kOnEachSide; });
}

}  // namespace

Result<std::vector<IdealSize>> ideal_sizes(const sim::SimOptions& options) {
  auto created = sim::Session::create(options);
  if (!created) return Error{created.error()};
  sim::Session& session = **created;
  const auto rectangles = rectangles_of(session);
  struct Visit {
    const sim::Interval* interval;
    std::optional<Start> start;
    std::vector<Contact> contacts;
  };
  std::vector<Visit> visits;
  for (const sim::Interval& interval : session.script().score.intervals)
    if (interval.label == "trace" && interval.contact_begin_s >= 0.0 && rectangles.contains(interval.object))
      visits.push_back({&interval, {}, {}});
  sim::Sample sample;
  for (double next_s = 0.0; session.next(sample);) {
    if (sample.time_s < next_s) continue;
    next_s = sample.time_s + kEvery;
    for (Visit& visit : visits) {
      if (!in_contact(*visit.interval, sample.time_s)) continue;
      if (!visit.start) visit.start = Start{sample.truth[sim::kPelvis], sample.reported[sim::kPelvis]};
      if (auto contact =
              contact_of(sample, *visit.start, rectangles.at(visit.interval->object), session.wearer().p_hand_touch))
        visit.contacts.push_back(*contact);
    }
  }
  std::map<int, std::pair<Edges, Edges>> found;  // by the suit's way, by the true one
  for (const Visit& visit : visits) {
    if (!all_round(visit.contacts)) continue;
    const MatrixXd arm = arm_covariance(visit.contacts, session.column());
    VectorXd by_suit(arm.rows()), by_truth(arm.rows());
    for (Eigen::Index k = 0; k < arm.rows(); ++k) {
      by_suit[k] = visit.contacts[static_cast<std::size_t>(k)].off_suit_way;
      by_truth[k] = visit.contacts[static_cast<std::size_t>(k)].off_true_way;
    }
    auto& [suit_way, true_way] = found[visit.interval->object];
    suit_way.add(visit.contacts, arm + way_covariance(visit.contacts, session.column()), by_suit);
    true_way.add(visit.contacts, arm, by_truth);
  }
  std::vector<IdealSize> out;
  for (const auto& [id, edges] : found) {
    const auto& size = rectangles.at(id).size;
    out.push_back({static_cast<std::uint32_t>(id), edges.first.percent(size), edges.second.percent(size)});
  }
  return out;
}

}  // namespace kinemap::bench
