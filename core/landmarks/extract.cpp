// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/extract.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/landmarks/corners.hpp"
#include "core/landmarks/geometry.hpp"
#include "core/landmarks/sides.hpp"
#include "core/landmarks/unbend.hpp"

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

constexpr double kMinPart = 3.0;         // s: an object that shares its gesture with another one takes so long to draw
constexpr double kMinBesideWall = 1.8;   // s: a wall after a wall
constexpr double kLongerWall = 1.5;      // × wall_min_extent_m, of a wall beside something else
constexpr double kCutStep = 0.75;        // s between the cuts that are tried in a gesture over two objects
constexpr double kPatience = 5.0;        // s: for so long what is drawn on a wall may look otherwise
constexpr double kWallOfSeveral = 1.0;   // m: each of several walls is longer; strokes in the air are shorter
constexpr double kMostOfAPart = 0.75;    // of the contacts of such a part are on its object
constexpr double kHighestEdge = 1.1;     // m over the floor, of a table that was not drawn all round
constexpr int kDeepest = 3;              // leftovers of leftovers
constexpr double kMostOfIt = 0.75;       // of the contacts lie on sides where sides were drawn
constexpr double kLongestPart = 2.5;     // m: longer is a wall, whatever else the hand did
constexpr double kNarrow = 0.3;          // m: of open rectangles, so little may be the hand's way to a side and from it
constexpr double kSecondChoice = 0.8;    // part of the trace that the surface that holds less of it must still hold
constexpr double kSmallestScreen = 0.3;  // m, its longer side: who points out something in the air draws rounds, too
constexpr double kFar = 0.15;            // m: farther off what was drawn is a lift-off or the way there

constexpr const char* kNeither = "an upright surface, but no closed contour and too short for a wall";

struct Attempt {
  std::optional<Observation> observation;
  std::string reason;
  bool rather_walls = false;    ///< a level contour with the wearer inside, or too high for a table
  bool part_of_screen = false;  ///< two or three sides of a rectangle: no wall
  bool round = false;           ///< and nothing else, though pieces of it may look like sides
  double misfit = HUGE_VAL;     ///< of a screen: mean square distance of the whole trace from its contour, m²
};

/// Members of the surface in its plane: first axis `u`, second `v`, from `origin`.
std::vector<Eigen::Vector2d> in_plane(std::span<const TracePoint> points, const Surface& surface,
                                      const Eigen::Vector3d& origin, const Eigen::Vector3d& u,
                                      const Eigen::Vector3d& v) {
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(surface.members.size());
  for (const std::size_t i : surface.members)
    flat.emplace_back(u.dot(points[i].p - origin), v.dot(points[i].p - origin));
  return flat;
}

/// A surface that leans is neither level nor upright: the plane of the paper's fit (SVD) must agree where the contacts
/// determine it.
bool leans(std::span<const TracePoint> points, const Surface& surface, double max_slant) {
  std::vector<Eigen::Vector3d> members;
  for (const std::size_t i : surface.members) members.push_back(points[i].p);
  const auto plane = fit_plane(members);
  if (!plane || plane->extent[1] < 0.1 || plane->extent[1] < 4.0 * plane->extent[2]) return false;
  return std::abs(plane->normal.dot(surface.normal)) < std::cos(max_slant);
}

/// Two walls round the corner of a room, drawn at one height, look like a table seen from within it.
bool wearer_inside(std::span<const TracePoint> points, const Surface& surface, const RectangleFit& fit) {
  constexpr double kWithin = 0.1;  // m
  const auto inside = std::count_if(surface.members.begin(), surface.members.end(), [&](std::size_t i) {
    const Eigen::Vector2d body = to_local(fit, points[i].p_body.head<2>());
    return std::abs(body.x()) < 0.5 * fit.size[0] - kWithin && std::abs(body.y()) < 0.5 * fit.size[1] - kWithin;
  });
  return 2 * static_cast<std::size_t>(inside) > surface.members.size();
}

/// Mean square distance of the contacts from the sides that were drawn, m²; where the contour is open a side goes on.
double contour_misfit(std::span<const Eigen::Vector2d> flat, const RectangleFit& fit) {
  double sum = 0.0;
  for (const Eigen::Vector2d& p : flat) {
    const Eigen::Vector2d local = to_local(fit, p);
    double nearest = kFar;
    for (const graph::Edge side : {graph::Edge::MinusU, graph::Edge::PlusU, graph::Edge::MinusV, graph::Edge::PlusV})
      if (fit.drawn[static_cast<std::size_t>(side) - 1])
        nearest = std::min(nearest, distance_from_side(local, fit.size, fit.drawn, side));
    sum += nearest * nearest;
  }
  return sum / static_cast<double>(flat.size());
}

/// Mean square distance of the contacts from the conic that fits them best, m² (Sampson's approximation).
double conic_misfit(std::span<const Eigen::Vector2d> flat) {
  Eigen::MatrixXd terms(flat.size(), 6);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : flat) mean += p / static_cast<double>(flat.size());
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const double x = flat[i].x() - mean.x(), y = flat[i].y() - mean.y();
    terms.row(static_cast<Eigen::Index>(i)) << x * x, x * y, y * y, x, y, 1.0;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(terms, Eigen::ComputeThinV);
  const Eigen::VectorXd c = svd.matrixV().col(5);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < terms.rows(); ++i) {
    const double x = terms(i, 3), y = terms(i, 4), value = terms.row(i).dot(c);
    const Eigen::Vector2d gradient(2.0 * c[0] * x + c[1] * y + c[3], c[1] * x + 2.0 * c[2] * y + c[4]);
    sum += value * value / std::max(1e-12, gradient.squaredNorm());
  }
  return sum / static_cast<double>(flat.size());
}

/// The way of the hand, m: along two axes (within 18°) and in all.
struct Strokes {
  double u = 0.0, v = 0.0, total = 0.0;
};
Strokes strokes_along(std::span<const Eigen::Vector2d> flat, double heading) {
  constexpr double kWindow = 0.05, kAlong = 0.95;  // m; cosine
  const auto travel = travel_directions(flat, kWindow);
  const Eigen::Vector2d u(std::cos(heading), std::sin(heading)), v(-u.y(), u.x());
  Strokes out;
  for (std::size_t i = 1; i < flat.size(); ++i) {
    const double step = (flat[i] - flat[i - 1]).norm();
    out.total += step;
    if (std::abs(u.dot(travel[i])) > kAlong) out.u += step;
    if (std::abs(v.dot(travel[i])) > kAlong) out.v += step;
  }
  return out;
}

/// Drawn in all directions alike, as nobody draws sides, and clearly better an ellipse: a round table, a mirror. As a
/// rectangle it would bend the way to it.
bool is_round(std::span<const Eigen::Vector2d> flat, const RectangleFit& fit) {
  constexpr double kLeast = 0.55, kBetter = 3.0;  // part of the way; times
  const Strokes way = strokes_along(flat, fit.heading);
  return way.u + way.v < kLeast * way.total && kBetter * conic_misfit(flat) < contour_misfit(flat, fit);
}

double shorter_side(const RectangleFit& fit) { return std::min(fit.size[0], fit.size[1]); }

std::vector<Eigen::Vector2d> from_above(std::span<const TracePoint> points, const Surface& surface) {
  return in_plane(points, surface, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
}

Attempt table(std::span<const TracePoint> bent, Surface surface, double floor_z, const LandmarkConfig& config) {
  const double height = surface.offset - floor_z;
  if (height < config.table_min_height_m || height > config.table_max_height_m)
    return {std::nullopt, "a level surface, but not at the height of a table"};
  const double rate = heading_rate(bent, [&](std::span<const TracePoint> points) {
    const auto flat = from_above(points, surface);
    const auto fit = fit_rectangle(flat, config);
    return fit ? contour_misfit(flat, *fit) : HUGE_VAL;
  });
  const auto points = unbent(bent, rate);
  auto fit = fit_rectangle(from_above(points, surface), config);
  if (fit && shorter_side(*fit) < kNarrow) {
    Surface drawn = surface;
    const IndexRange kept = without_way(from_above(points, surface), config);
    drawn.members.assign(surface.members.begin() + static_cast<std::ptrdiff_t>(kept.begin),
                         surface.members.begin() + static_cast<std::ptrdiff_t>(kept.end));
    const auto flat = from_above(points, drawn);
    const auto other = fit_rectangle(flat, config);
    if (other && shorter_side(*other) >= kNarrow && contour_misfit(flat, *other) < contour_misfit(flat, *fit)) {
      surface = std::move(drawn);
      fit = other;
    } else if (!fit->closed) {
      return {std::nullopt, "a level line with the hand's way to it and from it: one edge of a table, or a wall"};
    }
  }
  if (!fit) return {std::nullopt, "a level surface, but no two adjacent sides of a rectangle"};
  if (!fit->closed && height > kHighestEdge)
    return {std::nullopt, "an open level contour, higher than tables are", true};
  if (wearer_inside(points, surface, *fit)) return {std::nullopt, "a level contour round the wearer, no table", true};
  if (is_round(from_above(points, surface), *fit))
    return {std::nullopt, "a round level contour, no rectangle", false, false, true};
  Observation seen;
  seen.landmark.kind = LandmarkKind::Table;
  seen.landmark.x = {fit->centre.x(), fit->centre.y(), surface.offset, fit->heading, fit->size[0], fit->size[1], 0.0};
  seen.contacts = surface.members;
  seen.labels = fit->labels;
  seen.closed = fit->closed;
  return {seen, {}};
}

/// Level and plumb strokes as long as the sides, and hardly anything else: a part of a screen's contour. A hand that
/// waves on its way along a wall goes aslant.
bool drawn_in_strokes(std::span<const Eigen::Vector2d> flat, const RectangleFit& fit) {
  const auto [level, plumb, total] = strokes_along(flat, 0.0);
  return level + plumb > kMostOfIt * total && level > kMostOfIt * fit.size[0] && plumb > kMostOfIt * fit.size[1] &&
         std::max(fit.size[0], fit.size[1]) < kLongestPart && fit.size[1] > 0.25 * fit.size[0];
}

/// Mean square distance of the whole trace from a contour on an upright surface, m²: `flat` are the surface's members
/// in its plane.
double screen_misfit(std::span<const TracePoint> points, const Surface& surface, std::span<const Eigen::Vector2d> flat,
                     const RectangleFit& fit) {
  const auto members = static_cast<double>(flat.size()), all = static_cast<double>(points.size());
  double across = 0.0;
  for (const std::size_t i : surface.members) {
    const double off = surface.normal.dot(points[i].p) - surface.offset;
    across += off * off;
  }
  return (across + members * contour_misfit(flat, fit) + (all - members) * kFar * kFar) / all;
}

Attempt screen(std::span<const TracePoint> points, const Surface& surface, const LandmarkConfig& config) {
  const double heading = std::atan2(surface.normal.y(), surface.normal.x());
  const Eigen::Vector3d u(-std::sin(heading), std::cos(heading), 0.0);
  const Eigen::Vector3d foot = surface.offset * surface.normal;
  const auto flat = in_plane(points, surface, foot, u, Eigen::Vector3d::UnitZ());
  const auto fit = fit_rectangle(flat, config, 0.0);
  if (!fit) return {std::nullopt, kNeither};
  const auto labelled = std::count_if(fit->labels.begin(), fit->labels.end(),
                                      [](const SideLabel& l) { return l.edge != graph::Edge::None; });
  const double share = static_cast<double>(labelled) / static_cast<double>(flat.size());
  const bool clean = fit->rms <= 0.03 + 0.06 * std::min(fit->size[0], fit->size[1]);
  // A contour that goes round and comes back to where it began: a hand that waves along a wall does not.
  if (std::count(fit->drawn.begin(), fit->drawn.end(), true) < 3 ||
      std::abs(winding(flat, fit->centre)) < 1.4 * std::numbers::pi ||
      (flat.front() - flat.back()).norm() > 0.1 + 0.55 * std::max(fit->size[0], fit->size[1])) {
    if (clean && share > kMostOfIt && drawn_in_strokes(flat, *fit))
      return {std::nullopt, "an open contour on an upright surface: a part of a screen's", false, true};
    return {std::nullopt, kNeither};
  }
  if (!clean || share < 0.5) return {std::nullopt, "a closed contour on an upright surface, but not a rectangle"};
  if (std::max(fit->size[0], fit->size[1]) < kSmallestScreen)
    return {std::nullopt, "a closed contour on an upright surface, too small for a screen"};
  if (is_round(flat, *fit))
    return {std::nullopt, "a round contour on an upright surface, no rectangle", false, false, true};
  Observation seen;
  seen.landmark.kind = LandmarkKind::Screen;
  const Eigen::Vector3d centre = foot + fit->centre.x() * u + fit->centre.y() * Eigen::Vector3d::UnitZ();
  seen.landmark.x = {centre.x(), centre.y(), centre.z(), heading, fit->size[0], fit->size[1], 0.0};
  seen.contacts = surface.members;
  seen.labels = fit->labels;
  seen.closed = fit->closed;
  return {seen, {}, false, false, false, screen_misfit(points, surface, flat, *fit)};
}

/// A straight line at one height (as level as the arm of a bad suit keeps it), as low as tables are: one edge of a
/// table as likely as a wall.
bool may_be_table_edge(std::span<const TracePoint> points, const Surface& surface, double floor_z, double length) {
  constexpr double kHighest = 0.95, kLongest = 2.5, kSpread = 0.08;  // m
  std::vector<double> heights, off;
  for (const std::size_t i : surface.members) heights.push_back(points[i].p.z() - floor_z);
  const double height = median(heights);
  for (const double h : heights) off.push_back(std::abs(h - height));
  return height < kHighest && length < kLongest && 1.48 * median(std::move(off)) < kSpread;
}

/// `floor_z`: null where walls are expected, so that no line is taken for the edge of a table.
Attempt wall(std::span<const TracePoint> points, const Surface& surface, std::optional<double> floor_z,
             const LandmarkConfig& config) {
  const Eigen::Vector3d along(-surface.normal.y(), surface.normal.x(), 0.0);
  const double apart = std::abs(along.dot(points[surface.members.back()].p - points[surface.members.front()].p));
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (const std::size_t i : surface.members) {
    lo = std::min(lo, along.dot(points[i].p));
    hi = std::max(hi, along.dot(points[i].p));
  }
  // First and last contact far apart (paper, section IV): a hand that waves to and fro in the air does not get
  // anywhere.
  if (apart < config.wall_min_extent_m || apart < 0.4 * (hi - lo)) return {std::nullopt, kNeither};
  if (floor_z && may_be_table_edge(points, surface, *floor_z, hi - lo))
    return {std::nullopt, "a straight level line at the height of a table: one edge of it, or a wall"};
  Observation seen;
  seen.landmark.kind = LandmarkKind::Wall;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : surface.members) mean += points[i].p / static_cast<double>(surface.members.size());
  const double off = surface.normal.dot(mean) - surface.offset;
  seen.landmark.anchor = mean - off * surface.normal;  // near the contacts, on the plane
  seen.landmark.x[0] = std::atan2(surface.normal.y(), surface.normal.x());
  seen.landmark.x[1] = 0.0;
  seen.contacts = surface.members;
  seen.labels.assign(seen.contacts.size(), {});
  return {seen, {}};
}

Attempt classify(std::span<const TracePoint> points, const Surface& surface, double floor_z,
                 const LandmarkConfig& config) {
  if (leans(points, surface, config.max_slant_rad))
    return {std::nullopt, "the surface leans: neither level nor upright"};
  if (surface.kind == Surface::Kind::Level) return table(points, surface, floor_z, config);
  auto contour = screen(points, surface, config);
  if (contour.observation || contour.part_of_screen || contour.round) return contour;
  auto line = wall(points, surface, floor_z, config);
  return line.observation || contour.reason == kNeither ? line : contour;
}

void shift(Observation& observation, std::size_t by) {
  for (auto& index : observation.contacts) index += by;
}

/// A screen whose contour, points[begin, end), metal has bent so far that it lies on no one surface, or does not close,
/// or fits clearly better when it is straightened: the screen that it is without the turn of the heading.
std::optional<Observation> bent_screen(std::span<const TracePoint> all, IndexRange range,
                                       const LandmarkConfig& config) {
  const auto points = all.subspan(range.begin, range.end - range.begin);
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.p.z() < b.p.z(); });
  if (points.size() < 8 || high->p.z() - low->p.z() < config.rectangle_min_side_m) return std::nullopt;
  const auto attempt = [&](std::span<const TracePoint> tried) {
    const auto surface = find_upright_surface(tried, config);
    if (surface && !leans(tried, *surface, config.max_slant_rad)) return screen(tried, *surface, config);
    return Attempt{};
  };
  const double rate = heading_rate(points, [&](std::span<const TracePoint> tried) { return attempt(tried).misfit; });
  if (rate == 0.0) return std::nullopt;
  auto straightened = attempt(unbent(points, rate)).observation;
  if (straightened) shift(*straightened, range.begin);
  return straightened;
}

/// What most of points[begin, end) were drawn on.
struct MainObject {
  std::optional<Observation> observation;
  std::string reason;   ///< where it is none
  IndexRange contacts;  ///< of the object, else of the surface that was looked at
  bool round = false;   ///< see Attempt
};

MainObject main_object(std::span<const TracePoint> points, IndexRange range, double floor_z,
                       const LandmarkConfig& config) {
  const auto part = points.subspan(range.begin, range.end - range.begin);
  if (part.size() < 8) return {{}, "too few contacts", {range.begin, range.begin}};
  const auto surfaces = find_surfaces(part, config);
  if (surfaces.empty()) return {{}, "the hand did not stay on one surface", {range.begin, range.begin}};
  MainObject out;
  out.contacts = {range.begin + surfaces[0].members.front(), range.begin + surfaces[0].members.back() + 1};
  bool rather_walls = false;
  for (const Surface& surface : surfaces) {
    // One long edge of a table is no wall beside it, even where the table could not be made out.
    if (&surface != &surfaces[0] && surface.share < kSecondChoice && !rather_walls) break;
    auto attempt = classify(part, surface, floor_z, config);
    if (attempt.observation) {
      shift(*attempt.observation, range.begin);
      out.contacts = {attempt.observation->contacts.front(), attempt.observation->contacts.back() + 1};
      out.observation = std::move(attempt.observation);
      break;
    }
    if (out.reason.empty()) out.reason = attempt.reason;
    if (attempt.round) {
      out.reason = attempt.reason, out.round = true;
      break;
    }
    rather_walls = attempt.rather_walls;
  }
  return out;
}

bool is_rectangle(const Observation& seen) { return seen.landmark.kind != LandmarkKind::Wall; }

/// The hand is again where it began, as after the round of a contour. Cheap to ask.
bool comes_back(std::span<const TracePoint> points, IndexRange range) {
  double farthest = 0.0;
  for (std::size_t i = range.begin; i < range.end; ++i)
    farthest = std::max(farthest, (points[i].p - points[range.begin].p).norm());
  return range.begin < range.end && (points[range.end - 1].p - points[range.begin].p).norm() < 0.6 * farthest;
}

bool is_most_of(const Observation& seen, IndexRange range) {
  return static_cast<double>(seen.contacts.size()) >= kMostOfAPart * static_cast<double>(range.end - range.begin);
}

/// The one object that nearly all of points[begin, end) were drawn on, if there is one.
std::optional<Observation> single_object(std::span<const TracePoint> points, IndexRange range, double floor_z,
                                         const LandmarkConfig& config) {
  auto found = main_object(points, range, floor_z, config).observation;
  if (!(found && is_rectangle(*found)) && comes_back(points, range))
    if (auto bent = bent_screen(points, range, config)) found = std::move(bent);
  if (found && !is_most_of(*found, range)) found.reset();
  return found;
}

/// What is asked of an object that shares its gesture with another one.
struct PartRule {
  double min_s;           ///< it takes so long to draw
  LandmarkConfig config;  ///< a wall is longer than one that has a gesture of its own
};

/// Mostly it is the way to the other object, and straight ways look like walls. But who touches walls goes on to the
/// next wall, and may do that briefly.
PartRule part_rule(const LandmarkConfig& config, bool beside_wall) {
  PartRule rule{beside_wall ? kMinBesideWall : kMinPart, config};
  if (!beside_wall) rule.config.wall_min_extent_m *= kLongerWall;
  return rule;
}

/// A closed contour is no accident; two strokes on the way may be.
bool says_more(const Observation& a, const Observation& b) {
  return a.closed != b.closed ? a.closed : a.contacts.size() > b.contacts.size();
}

/// Looks for an object in what an object at one end (`after` it, or before) left of a gesture. The way between the two
/// may be long: it is cut off step by step. What then remains must be a rectangle, since a part that looks like a wall
/// can be cut out of any way.
void extract_leftover(std::span<const TracePoint> points, IndexRange range, bool after, double floor_z,
                      const PartRule& rule, int depth, std::vector<Observation>& out) {
  std::optional<Observation> best;
  const auto duration = [&](IndexRange r) {
    return r.begin < r.end ? points[r.end - 1].time_s - points[r.begin].time_s : 0.0;
  };
  for (IndexRange part = range; depth < kDeepest && duration(part) >= rule.min_s;) {
    auto found = single_object(points, part, floor_z, rule.config);
    if (found && !is_rectangle(*found) && duration(part) < duration(range)) found.reset();
    if (found && (!best || says_more(*found, *best))) best = std::move(found);
    const double shorter = duration(part) - kCutStep;
    while (part.begin < part.end && duration(part) > shorter) after ? ++part.begin : --part.end;
  }
  if (!best) return;
  // What is nearer to the other object is the way: a hand that is carried level looks like a table.
  const IndexRange rest =
      after ? IndexRange{best->contacts.back() + 1, range.end} : IndexRange{range.begin, best->contacts.front()};
  out.push_back(std::move(*best));
  extract_leftover(points, rest, after, floor_z, rule, depth + 1, out);
}

Eigen::Vector3d middle(std::span<const TracePoint> points, const Observation& seen) {
  return points[seen.contacts[seen.contacts.size() / 2]].p;
}

bool as_low_as_tables(std::span<const TracePoint> points, const Observation& seen, double floor_z) {
  return middle(points, seen).z() - floor_z < kHighestEdge;
}

/// How far in front of the other, m, the one of two walls is that is less so: > 0 at an inner corner of a room.
double in_front_of_each_other(std::span<const TracePoint> points, const Observation& a, const Observation& b) {
  const auto before = [&](const Observation& wall, const Eigen::Vector3d& p) {
    const double heading = wall.landmark.x[0];
    return Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0).dot(p - wall.landmark.anchor);
  };
  return std::min(before(a, middle(points, b)), before(b, middle(points, a)));
}

/// Two edges of a table, seen from outside its corner, look like two walls; walls at that height surround the wearer.
bool may_be_table_corner(std::span<const TracePoint> points, const Observation& a, const Observation& b,
                         double floor_z) {
  if (is_rectangle(a) || is_rectangle(b)) return false;
  return as_low_as_tables(points, a, floor_z) && as_low_as_tables(points, b, floor_z) &&
         in_front_of_each_other(points, a, b) <= 0.0;
}

/// Where a gesture over two objects may be cut in time so that each part is long enough.
std::vector<std::size_t> cuts_of(std::span<const TracePoint> points, IndexRange range, const PartRule& rule) {
  std::vector<std::size_t> cuts;
  double next_s = points[range.begin].time_s + rule.min_s;
  for (std::size_t cut = range.begin; cut < range.end; ++cut) {
    if (points[cut].time_s < next_s) continue;
    if (points[range.end - 1].time_s - points[cut].time_s < rule.min_s) break;
    next_s = points[cut].time_s + kCutStep;
    cuts.push_back(cut);
  }
  return cuts;
}

/// Two contours one after the other: the hand comes back to where it began, and later ends where it was before.
bool may_be_two_contours(std::span<const TracePoint> points, IndexRange range, const PartRule& rule) {
  bool first = false;
  for (const std::size_t cut : cuts_of(points, range, rule)) {
    first = first || comes_back(points, {range.begin, cut});
    if (first && comes_back(points, {cut, range.end})) return true;
  }
  return false;
}

/// A gesture over two objects one after the other, of which neither stands out in the whole: two walls touched at one
/// height look like a level surface, two screens like none, or like a wall. Tries cuts in time, one where the first
/// object ends and one where the second begins, since the way between rectangles may be long; both parts must be
/// objects by themselves.
std::vector<Observation> two_objects(std::span<const TracePoint> points, IndexRange range, double floor_z,
                                     const PartRule& rule) {
  const std::vector<std::size_t> cuts = cuts_of(points, range, rule);
  std::vector<std::optional<Observation>> before, after;
  for (const std::size_t cut : cuts) {
    before.push_back(single_object(points, {range.begin, cut}, floor_z, rule.config));
    after.push_back(single_object(points, {cut, range.end}, floor_z, rule.config));
  }
  const Observation *first = nullptr, *second = nullptr;
  std::pair<bool, std::size_t> most{false, 0};  // closed contours, and contacts explained
  for (std::size_t a = 0; a < cuts.size(); ++a) {
    for (std::size_t b = a; before[a] && b < cuts.size(); ++b) {
      if (!after[b] || (a != b && !(is_rectangle(*before[a]) && is_rectangle(*after[b])))) continue;
      const std::pair explained{before[a]->closed && after[b]->closed,
                                before[a]->contacts.size() + after[b]->contacts.size()};
      if (explained <= most || may_be_table_corner(points, *before[a], *after[b], floor_z)) continue;
      most = explained;
      first = &*before[a], second = &*after[b];
    }
  }
  if (first == nullptr) return {};
  return {*first, *second};
}

std::size_t contacts_of(const std::vector<Observation>& seen) {
  return std::accumulate(seen.begin(), seen.end(), std::size_t{0},
                         [](std::size_t sum, const Observation& o) { return sum + o.contacts.size(); });
}

/// A gesture along three walls or more, one after the other, as when one walks round a room with the hand on the wall:
/// each as long as the hand stays on it. Empty where that leaves out more than the hand's way from one to the next, or
/// where it looks like the edges of something that the wearer walked round.
std::vector<Observation> walls_one_after_the_other(std::span<const TracePoint> points, IndexRange range, double floor_z,
                                                   LandmarkConfig config) {
  config.wall_min_extent_m = kWallOfSeveral;
  const auto wall_in = [&](IndexRange part) {
    const auto tried = points.subspan(part.begin, part.end - part.begin);
    const auto surface = find_upright_surface(tried, config);
    auto found = surface ? wall(tried, *surface, std::nullopt, config).observation : std::nullopt;
    if (found) shift(*found, part.begin);
    return found && is_most_of(*found, part) ? found : std::nullopt;
  };
  const auto seconds_after = [&](std::size_t from, double seconds) {
    std::size_t to = from;
    while (to < range.end && points[to].time_s - points[from].time_s < seconds) ++to;
    return to;
  };
  std::vector<Observation> walls;
  for (std::size_t begin = range.begin; begin < range.end;) {
    std::optional<Observation> longest;
    std::size_t end = seconds_after(begin, kMinBesideWall), give_up = seconds_after(begin, kPatience);
    while (end <= give_up) {
      if (auto found = wall_in({begin, end})) {
        longest = std::move(found);
        give_up = seconds_after(end - 1, kPatience);
      }
      if (end == range.end) break;
      end = seconds_after(end, kCutStep);
    }
    begin = longest ? longest->contacts.back() + 1 : seconds_after(begin, kCutStep);
    if (longest) walls.push_back(std::move(*longest));
  }
  int low = 0, inner = 0;
  for (std::size_t k = 1; k < walls.size(); ++k) {
    if (!as_low_as_tables(points, walls[k], floor_z)) continue;
    ++low, inner += in_front_of_each_other(points, walls[k - 1], walls[k]) > 0.0 ? 1 : 0;
  }
  const bool most =
      static_cast<double>(contacts_of(walls)) >= kMostOfAPart * static_cast<double>(range.end - range.begin);
  if (walls.size() < 3 || !most || (low > 0 && 2 * inner <= low)) walls.clear();
  return walls;
}

}  // namespace

Extraction extract_landmarks(std::span<const TracePoint> points, double floor_z, const LandmarkConfig& config) {
  Extraction out;
  const IndexRange drawn = without_reach(points, config);
  auto main = main_object(points, drawn, floor_z, config);
  if (main.round) return {{}, main.reason, main.contacts};
  const PartRule part = part_rule(config, false);
  const bool wall = main.observation && !is_rectangle(*main.observation);
  std::vector<Observation> walls;
  if (!main.observation || (wall && !is_most_of(*main.observation, drawn)))
    walls = walls_one_after_the_other(points, drawn, floor_z, config);
  if (!main.observation && !walls.empty() && !may_be_two_contours(points, drawn, part))
    return {std::move(walls), {}, {}};
  // Two rectangles are no accident; walls can be cut out of a bent contour.
  const auto all_rectangles = [](const std::vector<Observation>& seen) {
    return !seen.empty() && std::ranges::all_of(seen, is_rectangle);
  };
  if (drawn.end > drawn.begin && (wall ? may_be_two_contours(points, drawn, part) : !main.observation)) {
    auto two = two_objects(points, drawn, floor_z, part);
    if (!wall || (all_rectangles(two) && two[0].closed && two[1].closed))
      out.observations = std::move(two), main.observation.reset();
  }
  const bool rectangles =
      main.observation ? main.observation->landmark.kind == LandmarkKind::Table : all_rectangles(out.observations);
  if (!rectangles) {
    if (auto bent = bent_screen(points, drawn, config)) {
      out.observations.clear();
      main.contacts = {bent->contacts.front(), bent->contacts.back() + 1};
      main.observation = std::move(bent);
    }
  }
  const PartRule rule = part_rule(config, main.observation && !is_rectangle(*main.observation));
  if (main.observation) out.observations.push_back(std::move(*main.observation));
  if (out.observations.size() < 2) {
    extract_leftover(points, {drawn.begin, main.contacts.begin}, false, floor_z, rule, 0, out.observations);
    extract_leftover(points, {main.contacts.end, drawn.end}, true, floor_z, rule, 0, out.observations);
  }
  if (std::ranges::none_of(out.observations, is_rectangle) && contacts_of(walls) > contacts_of(out.observations))
    out.observations = std::move(walls);
  if (out.observations.empty()) out.reason = main.reason, out.tried = main.contacts;
  std::sort(out.observations.begin(), out.observations.end(),
            [](const Observation& a, const Observation& b) { return a.contacts.front() < b.contacts.front(); });
  return out;
}

}  // namespace kinemap
