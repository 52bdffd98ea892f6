// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/associate.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/mapper/relocate.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {
namespace {

using graph::Edge;
using graph::Landmark;
using graph::LandmarkKind;

constexpr double kOnPlane = 0.25;    // m: contacts farther from their wall do not speak of its extent
constexpr double kMaxTurn = 0.8;     // rad: objects are not mistaken for ones that stand crosswise
constexpr double kOverlap = 0.3;     // part of the shorter of two stretches that two visits to one wall share
constexpr double kAlongSigma = 0.1;  // m: what two visits differ by along the wall beyond the drift between them
constexpr double kMaxMissing = 0.4;  // m of that overlap that drift may have taken; stretches farther apart stay two
// How widely objects of a kind vary: m, m² for the two sizes.
constexpr double kTableHeights = 0.3, kTableSizes = 1.0;
constexpr double kScreenHeights = 0.8, kScreenSizes = 0.7;
constexpr double kSeatHeights = 0.2;
constexpr double kSeatWidth = 0.4;  // m: seats nearer than that are one
constexpr double kSeatsNear = 1.2;  // m: seats about one …
constexpr double kLikeThose = 0.3;  // … of which so many times as many again are expected there
constexpr double kHalfPi = std::numbers::pi / 2.0;

double squared(double x) { return x * x; }

/// What the newcomer `a` differs from landmark `b` by, as a function of their numbers, so that its Jacobian can be had
/// numerically.
struct Difference {
  std::function<Eigen::VectorXd(const Landmark&, const Landmark&)> of;
  Eigen::VectorXd noise;  ///< standard deviations beyond the graph's covariance
  int places = 2;         ///< so many of its first numbers say where the object is, the others what it is like
  double density = 0.0;   ///< of objects of the kind, per m or m² (`places`)
  double variety = 1.0;   ///< probability density of the other numbers among objects of the kind
  int quarter_turns = 0;
  std::vector<Eigen::Vector2d> neighbours;  ///< differences in place of one like it that stands flush beside it, m
};

Difference wall_difference(const MapState& state, std::size_t a, const MapperConfig::Association& config) {
  // At the middle of the newcomer's own contacts, where its offset and heading are least correlated.
  const auto interval = contact_interval(state, a).value_or(Interval{});
  const double half = std::max(0.3, 0.5 * (interval.hi - interval.lo));
  const double middle = 0.5 * (interval.lo + interval.hi);
  Difference d;
  d.of = [middle](const Landmark& x, const Landmark& y) {
    const Eigen::Vector3d p = WallFrame(x).point(middle);
    return Eigen::VectorXd(Eigen::Vector2d(WallFrame(y).distance(p), wrap_angle(x.x[0] - y.x[0])));
  };
  d.noise =
      Eigen::Vector2d(config.position_sigma_m, std::max(config.heading_sigma_rad, config.position_sigma_m / half));
  d.places = 1;
  d.density = config.wall_density_per_m;
  d.variety = 1.0 / kHalfPi;
  return d;
}

/// The four ways round in which a table's axes may have been named; the one that turns it least.
int quarter_turns(double heading_a, double heading_b) {
  return static_cast<int>(std::lround(wrap_angle(heading_a - heading_b) / kHalfPi)) & 3;
}

Difference table_difference(const Landmark& a, const Landmark& b, const MapperConfig::Association& config) {
  const int turns = quarter_turns(a.x[3], b.x[3]);
  // What of the newcomer lies along the known one's u and v.
  const std::size_t u = turns % 2 == 0 ? 4 : 5, v = turns % 2 == 0 ? 5 : 4;
  Difference d;
  d.quarter_turns = turns;
  d.of = [turns, u, v](const Landmark& x, const Landmark& y) {
    Eigen::VectorXd e(6);
    e << x.x[0] - y.x[0], x.x[1] - y.x[1], x.x[2] - y.x[2], wrap_angle(x.x[3] - y.x[3] - turns * kHalfPi),
        x.x[u] - y.x[4], x.x[v] - y.x[5];
    return e;
  };
  d.noise.resize(6);
  d.noise << config.position_sigma_m, config.position_sigma_m, config.position_sigma_m, config.heading_sigma_rad,
      config.size_sigma_m + config.size_sigma_per_m * b.x[4], config.size_sigma_m + config.size_sigma_per_m * b.x[5];
  d.density = config.table_density_per_m2;
  const Eigen::Rotation2Dd turn(b.x[3]);
  for (const double half : {-0.5, 0.5}) {
    d.neighbours.emplace_back(turn * Eigen::Vector2d(half * (a.x[u] + b.x[4]), 0.0));
    d.neighbours.emplace_back(turn * Eigen::Vector2d(0.0, half * (a.x[v] + b.x[5])));
  }
  d.variety = 1.0 / (kTableHeights * kHalfPi * kTableSizes);
  return d;
}

Difference screen_difference(const Landmark& a, const Landmark& b, const MapperConfig::Association& config) {
  Difference d;
  d.of = [](const Landmark& x, const Landmark& y) {
    Eigen::VectorXd e(6);
    e << x.x[0] - y.x[0], x.x[1] - y.x[1], x.x[2] - y.x[2], wrap_angle(x.x[3] - y.x[3]), x.x[4] - y.x[4],
        x.x[5] - y.x[5];
    return e;
  };
  d.noise.resize(6);
  const double heading = std::max(config.heading_sigma_rad, config.position_sigma_m / std::max(0.3, b.x[4]));
  d.noise << config.position_sigma_m, config.position_sigma_m, config.position_sigma_m, heading,
      config.size_sigma_m + config.size_sigma_per_m * b.x[4], config.size_sigma_m + config.size_sigma_per_m * b.x[5];
  d.density = config.screen_density_per_m2;
  for (const double half : {-0.5, 0.5})
    d.neighbours.emplace_back(Eigen::Rotation2Dd(b.x[3]) * Eigen::Vector2d(0.0, half * (a.x[4] + b.x[4])));
  d.variety = 1.0 / (kScreenHeights * 4.0 * kHalfPi * kScreenSizes);
  return d;
}

/// Seats come in rows and round tables: about known ones more are to be expected than elsewhere.
double seat_density(const MapState& state, std::size_t a, std::size_t b, const MapperConfig::Association& config) {
  const auto& landmarks = state.graph.landmarks;
  int near = 0;
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const Landmark& other = landmarks[k];
    if (k == a || k == b || !other.active || other.kind != LandmarkKind::Seat || state.landmarks[k].id == 0) continue;
    if (std::hypot(other.x[0] - landmarks[b].x[0], other.x[1] - landmarks[b].x[1]) < kSeatsNear) ++near;
  }
  return config.seat_density_per_m2 + kLikeThose * near / (std::numbers::pi * squared(kSeatsNear));
}

Difference seat_difference(const MapState& state, std::size_t a, std::size_t b,
                           const MapperConfig::Association& config) {
  Difference d;
  d.of = [](const Landmark& x, const Landmark& y) {
    return Eigen::VectorXd(
        Eigen::Vector4d(x.x[0] - y.x[0], x.x[1] - y.x[1], x.x[2] - y.x[2], wrap_angle(x.x[3] - y.x[3])));
  };
  d.noise = Eigen::Vector4d(config.position_sigma_m, config.position_sigma_m, 0.5 * config.position_sigma_m, 0.2);
  d.density = seat_density(state, a, b, config);
  d.variety = 1.0 / (kSeatHeights * 4.0 * kHalfPi);
  return d;
}

Difference difference(const MapState& state, std::size_t a, std::size_t b, const MapperConfig::Association& config) {
  const auto& landmarks = state.graph.landmarks;
  switch (landmarks[a].kind) {
    case LandmarkKind::Wall:
      return wall_difference(state, a, config);
    case LandmarkKind::Table:
      return table_difference(landmarks[a], landmarks[b], config);
    case LandmarkKind::Screen:
      return screen_difference(landmarks[a], landmarks[b], config);
    case LandmarkKind::Seat:
      return seat_difference(state, a, b, config);
    case LandmarkKind::Direction:
      break;  // there is one alone
  }
  return {};
}

/// Central differences of `d.of` in the numbers of both landmarks, side by side.
Eigen::MatrixXd jacobian(const Difference& d, const Landmark& a, const Landmark& b) {
  constexpr double kStep = 1e-6;
  const int na = graph::dimension(a.kind), nb = graph::dimension(b.kind);
  Eigen::MatrixXd j(d.noise.size(), na + nb);
  for (int k = 0; k < na + nb; ++k) {
    Landmark a0 = a, a1 = a, b0 = b, b1 = b;
    const auto n = static_cast<std::size_t>(k < na ? k : k - na);
    (k < na ? a0 : b0).x[n] -= kStep;
    (k < na ? a1 : b1).x[n] += kStep;
    j.col(k) = (d.of(a1, b1) - d.of(a0, b0)) / (2.0 * kStep);
  }
  return j;
}

/// 2 ln of a normal density at e.
double twice_log_density(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance) {
  const auto ldlt = covariance.ldlt();
  return -e.dot(ldlt.solve(e)) - ldlt.vectorD().array().max(1e-300).log().sum() -
         static_cast<double>(e.size()) * std::log(2.0 * std::numbers::pi);
}

/// 2 ln of the odds that a difference `e` with covariance `s` is between two visits to one object.
double evidence(const Difference& d, const Eigen::VectorXd& e, const Eigen::MatrixXd& s,
                const MapperConfig::Association& config) {
  const Eigen::Index likeness = e.size() - d.places;
  const double alike = std::exp(0.5 * twice_log_density(e.tail(likeness), s.bottomRightCorner(likeness, likeness)));
  double another = d.density * (config.look_alike_share * alike + (1.0 - config.look_alike_share) * d.variety);
  for (const Eigen::Vector2d& neighbour : d.neighbours) {
    Eigen::VectorXd from_there = e;
    from_there.head<2>() -= neighbour;
    another += config.neighbour_share * std::exp(0.5 * twice_log_density(from_there, s));
  }
  return twice_log_density(e, s) - 2.0 * std::log(another);
}

std::optional<std::size_t> last_visit(const MapState& state, std::size_t landmark) {
  for (std::size_t k = state.observations.size(); k-- > 0;)
    if (state.observations[k].landmark == landmark) return state.observations[k].key_pose;
  return std::nullopt;
}

/// Where along the wall its visits touched it, all but `except`.
std::optional<Interval> touched_by_visits(const MapState& state, std::size_t wall, std::optional<std::size_t> except) {
  const WallFrame frame(state.graph.landmarks[wall]);
  std::optional<Interval> out;
  for (std::size_t v = 0; v < state.observations.size(); ++v) {
    if (v == except || state.observations[v].landmark != wall) continue;
    const auto touched = contact_interval(state, state.observations[v], frame);
    if (!touched) continue;
    if (!out) out = touched;
    out->lo = std::min(out->lo, touched->lo), out->hi = std::max(out->hi, touched->hi);
  }
  return out;
}

/// What two visits to one wall would share along it, and do not, m; ≤ 0 where they share enough.
double missing_overlap(const Interval& a, const Interval& b) {
  const double shared = std::min(a.hi, b.hi) - std::max(a.lo, b.lo);
  return kOverlap * std::min(a.hi - a.lo, b.hi - b.lo) - shared;
}

/// Walls that continue each other are told apart by where along them they were touched: squared sigmas, each `doubt`
/// times as wide; nullopt when too far apart.
std::optional<double> along_wall_distance(const MapState& state, const graph::Marginals& marginals, std::size_t a,
                                          std::size_t b, double doubt) {
  const auto ia = contact_interval(state, a), ib = contact_interval(state, b);
  const auto visit_a = last_visit(state, a), visit_b = last_visit(state, b);
  if (!ia || !ib || !visit_a || !visit_b) return 0.0;
  const WallFrame fa(state.graph.landmarks[a]), fb(state.graph.landmarks[b]);
  const double s0 = fb.along(fa.point(ia->lo)), s1 = fb.along(fa.point(ia->hi));
  const double missing = missing_overlap({std::min(s0, s1), std::max(s0, s1)}, *ib);
  if (missing <= 0.0) return 0.0;
  if (missing > kMaxMissing) return std::nullopt;
  const double variance = squared(kAlongSigma) + variance_along(state, marginals, *visit_a, *visit_b, fb.axis);
  return squared(missing) / (squared(doubt) * variance);
}

/// A table, screen or seat as a box along the axes of `heading`: ahead, to the left, up; m.
struct Box {
  Eigen::Vector3d centre, size;
};
Box box_of(const Landmark& l, double heading) {
  constexpr double kDepth = 0.3;  // m, of what is flat
  const double c = std::cos(heading), s = std::sin(heading);
  Box box;
  box.centre = {c * l.x[0] + s * l.x[1], c * l.x[1] - s * l.x[0], l.x[2]};
  if (l.kind == LandmarkKind::Screen)
    box.size = {kDepth, l.x[4], l.x[5]};
  else if (l.kind == LandmarkKind::Seat)
    box.size = Eigen::Vector3d::Constant(kSeatWidth);
  else if (quarter_turns(l.x[3], heading) % 2 == 0)
    box.size = {l.x[4], l.x[5], kDepth};
  else
    box.size = {l.x[5], l.x[4], kDepth};
  return box;
}

Edge turned(Edge edge, int quarter_turns) {
  // Counter-clockwise round the rectangle: what is +u in the newcomer's axes is +v in axes turned back by 90°.
  constexpr std::array<Edge, 4> round{Edge::PlusU, Edge::PlusV, Edge::MinusU, Edge::MinusV};
  if (edge == Edge::None) return edge;
  const auto at = static_cast<std::size_t>(std::find(round.begin(), round.end(), edge) - round.begin());
  return round[(at + static_cast<std::size_t>(quarter_turns)) % 4];
}

}  // namespace

double gate(double sigma, int dimensions) {
  // z such that a χ²(1) variable exceeds sigma² as often as a standard normal one exceeds z; then Wilson–Hilferty for k
  // dimensions.
  const double tail = std::erfc(sigma / std::numbers::sqrt2);
  double lo = 0.0, hi = 10.0;
  for (int n = 0; n < 60; ++n) {
    const double z = 0.5 * (lo + hi);
    (0.5 * std::erfc(z / std::numbers::sqrt2) > tail ? lo : hi) = z;
  }
  const double k = dimensions, h = 2.0 / (9.0 * k);
  return k * std::pow(1.0 - h + lo * std::sqrt(h), 3.0);
}

double variance_along(const MapState& state, const graph::Marginals& marginals, std::size_t i, std::size_t j,
                      const Eigen::Vector3d& axis) {
  if (i == j) return 0.0;
  std::vector<graph::Variable> poses;
  Eigen::Matrix<double, 1, 12> h = Eigen::Matrix<double, 1, 12>::Zero();
  const auto add = [&](std::size_t pose, double sign) {
    if (pose < state.graph.first_free_pose) return;  // a constant
    const auto column = static_cast<Eigen::Index>(6 * poses.size());
    h.segment<3>(column) = sign * axis.transpose() * state.graph.poses[pose].q.toRotationMatrix();
    poses.push_back({graph::Variable::Kind::Pose, pose});
  };
  add(i, 1.0), add(j, -1.0);
  const auto used = h.leftCols(static_cast<Eigen::Index>(6 * poses.size()));
  return poses.empty() ? 0.0 : (used * marginals.joint(poses) * used.transpose())(0, 0);
}

std::vector<double> contacts_along(const MapState& state, const ObservationRecord& visit, const WallFrame& frame) {
  std::vector<double> out;
  const auto add = [&](const Eigen::Vector3d& p) {
    if (std::abs(frame.distance(p)) <= kOnPlane) out.push_back(frame.along(p));
  };
  for (std::size_t k = visit.first_contact; k < visit.first_contact + visit.contacts; ++k) {
    const auto& c = state.graph.contacts[k];
    add(state.graph.poses[c.i] * (c.T_i_hand * state.graph.touch_points[c.touch].p_hand));
  }
  if (visit.settled && visit.settled->touched)
    std::for_each(visit.settled->touched->begin(), visit.settled->touched->end(), add);
  return out;
}

std::optional<Interval> contact_interval(const MapState& state, const ObservationRecord& visit,
                                         const WallFrame& frame) {
  const auto along = contacts_along(state, visit, frame);
  if (along.empty()) return std::nullopt;
  const auto [lo, hi] = std::minmax_element(along.begin(), along.end());
  return Interval{*lo, *hi};
}

std::optional<Interval> contact_interval(const MapState& state, std::size_t wall) {
  return touched_by_visits(state, wall, std::nullopt);
}

bool touched_elsewhere(const MapState& state, std::size_t visit) {
  const auto& record = state.observations[visit];
  const Landmark& landmark = state.graph.landmarks[record.landmark];
  if (landmark.kind != LandmarkKind::Wall) return false;
  const auto here = contact_interval(state, record, WallFrame(landmark));
  const auto others = touched_by_visits(state, record.landmark, visit);
  return here && others && missing_overlap(*here, *others) > kMaxMissing;
}

bool in_one_place(const Landmark& a, const Landmark& b) {
  if (a.kind != b.kind || a.kind == LandmarkKind::Wall || a.kind == LandmarkKind::Direction) return false;
  if (a.kind == LandmarkKind::Screen && std::abs(wrap_angle(a.x[3] - b.x[3])) > kMaxTurn) return false;  // two faces
  const Box x = box_of(a, b.x[3]), y = box_of(b, b.x[3]);
  const Eigen::Array3d apart = (x.centre - y.centre).cwiseAbs();
  const Eigen::Array3d shared = (0.5 * (x.size + y.size).array() - apart).min(x.size.array().min(y.size.array()));
  return shared.minCoeff() > 0.0 && 2.0 * shared.prod() > std::min(x.size.prod(), y.size.prod());
}

std::vector<Candidate> candidates(const MapState& state, std::size_t newcomer, const graph::Marginals& marginals,
                                  const MapperConfig::Association& config) {
  std::vector<Candidate> out;
  const auto& landmarks = state.graph.landmarks;
  const Landmark& a = landmarks[newcomer];
  const std::vector<bool> beyond = beyond_break(state);
  for (std::size_t other = 0; other < landmarks.size(); ++other) {
    const Landmark& b = landmarks[other];
    if (!beyond.empty() && beyond[newcomer] != beyond[other]) continue;
    if (state.landmarks[other].id == 0) continue;  // its own turn comes
    if (other == newcomer || !b.active || b.kind != a.kind || a.kind == LandmarkKind::Direction) continue;
    const Difference d = difference(state, newcomer, other, config);
    const Eigen::VectorXd e = d.of(a, b);
    if (std::abs(e[a.kind == LandmarkKind::Wall ? 1 : 3]) > kMaxTurn) continue;
    const std::array<graph::Variable, 2> pair{graph::Variable{graph::Variable::Kind::Landmark, newcomer},
                                              graph::Variable{graph::Variable::Kind::Landmark, other}};
    const Eigen::MatrixXd j = jacobian(d, a, b);
    Eigen::MatrixXd s = j * marginals.joint(pair) * j.transpose();
    Eigen::MatrixXd doubted = squared(config.doubt) * s;
    s.diagonal() += d.noise.cwiseAbs2();
    doubted.diagonal() += std::max(1.0, squared(config.doubt)) * d.noise.cwiseAbs2();
    Candidate candidate{other, d.quarter_turns, e.dot(doubted.ldlt().solve(e)), static_cast<int>(e.size()),
                        evidence(d, e, doubted, config)};
    // Two cannot stand in one place: when they seem to, that is no sign of a drift as wide as the doubt.
    if (in_one_place(a, b)) candidate.evidence = std::max(candidate.evidence, evidence(d, e, s, config));
    if (a.kind == LandmarkKind::Wall) {
      const auto along = along_wall_distance(state, marginals, newcomer, other, config.doubt);
      if (!along) continue;
      candidate.distance += *along, candidate.evidence -= *along, ++candidate.dimensions;
    }
    if (candidate.distance <= gate(config.gate_sigma, candidate.dimensions)) out.push_back(candidate);
  }
  std::sort(out.begin(), out.end(), [](const Candidate& x, const Candidate& y) { return x.evidence > y.evidence; });
  return out;
}

void merge(MapState& state, std::size_t from, const Candidate& candidate) {
  const std::size_t to = candidate.landmark;
  for (auto& visit : state.observations) {
    if (visit.landmark != from) continue;
    visit.landmark = to;
    for (std::size_t k = visit.first_contact; k < visit.first_contact + visit.contacts; ++k) {
      auto& contact = state.graph.contacts[k];
      contact.landmark = to;
      contact.edge = turned(contact.edge, candidate.quarter_turns);
      contact.corner = turned(contact.corner, candidate.quarter_turns);
    }
    if (visit.has_seat()) state.graph.seats[visit.seat].landmark = to;
  }
  for (auto& folded : state.graph.folded) {
    if (folded.landmark != from) continue;
    folded.landmark = to;
    folded.quarter_turns = (folded.quarter_turns + candidate.quarter_turns) % 4;
  }
  state.graph.landmarks[from].active = false;
  std::erase_if(state.graph.parallels, [from](const graph::ParallelFactor& f) { return f.b == from; });
  auto& record = state.landmarks[to];
  const auto& other = state.landmarks[from];
  record.observations += other.observations;
  record.first_seen_s = std::min(record.first_seen_s, other.first_seen_s);
  record.last_seen_s = std::max(record.last_seen_s, other.last_seen_s);
}

std::size_t split(MapState& state, std::size_t visit) {
  ObservationRecord& record = state.observations[visit];
  const std::size_t from = record.landmark, to = state.graph.landmarks.size();
  state.graph.landmarks.push_back(state.graph.landmarks[from]);
  state.landmarks.push_back({0, 1, record.begin_s, record.end_s, state.landmarks[from].floor_z});
  const auto priors = state.graph.landmark_priors;
  for (auto prior : priors) {
    if (prior.landmark != from) continue;
    prior.landmark = to;
    state.graph.landmark_priors.push_back(prior);
  }
  record.landmark = to;
  for (std::size_t k = record.first_contact; k < record.first_contact + record.contacts; ++k)
    state.graph.contacts[k].landmark = to;
  if (record.has_seat()) state.graph.seats[record.seat].landmark = to;

  LandmarkRecord& rest = state.landmarks[from];
  rest.observations = 0, rest.first_seen_s = HUGE_VAL, rest.last_seen_s = -HUGE_VAL;
  for (const auto& other : state.observations) {
    if (other.landmark != from) continue;
    ++rest.observations;
    rest.first_seen_s = std::min(rest.first_seen_s, other.begin_s);
    rest.last_seen_s = std::max(rest.last_seen_s, other.end_s);
  }
  return to;
}

}  // namespace kinemap
