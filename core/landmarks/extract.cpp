// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/extract.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/landmarks/geometry.hpp"
#include "core/landmarks/sides.hpp"
#include "core/landmarks/unbend.hpp"

namespace kinemap {
namespace {

using graph::Landmark;
using graph::LandmarkKind;

constexpr double kMinLeftover = 3.0;   // s
constexpr double kCutStep = 0.75;      // s between the cuts that are tried in a gesture over two objects
constexpr double kMostOfAPart = 0.75;  // of the contacts of such a part are on its object
constexpr double kHighestEdge = 1.1;   // m over the floor, of a table
constexpr int kDeepest = 3;            // leftovers of leftovers
constexpr int kNoLeftovers = kDeepest;
constexpr double kMostOfIt = 0.75;     // of the contacts lie on sides where sides were drawn
constexpr double kLongestPart = 2.5;   // m: longer is a wall, whatever else the hand did
constexpr double kSecondChoice = 0.8;  // part of the trace that the surface that holds less of it must still hold

struct Attempt {
  std::optional<Observation> observation;
  std::string reason;
  bool round_wearer = false;    ///< a level contour with the wearer inside: walls
  bool part_of_screen = false;  ///< two or three sides of a rectangle: no wall
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
  constexpr double kFar = 0.15;  // m: farther off is a lift-off or the way there
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

std::vector<Eigen::Vector2d> from_above(std::span<const TracePoint> points, const Surface& surface) {
  return in_plane(points, surface, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
}

Attempt table(std::span<const TracePoint> bent, const Surface& surface, double floor_z, const LandmarkConfig& config) {
  const double height = surface.offset - floor_z;
  if (height < config.table_min_height_m || height > config.table_max_height_m)
    return {std::nullopt, "a level surface, but not at the height of a table"};
  const double rate = heading_rate(bent, [&](std::span<const TracePoint> points) {
    const auto flat = from_above(points, surface);
    const auto fit = fit_rectangle(flat, config);
    return fit ? contour_misfit(flat, *fit) : HUGE_VAL;
  });
  const auto points = unbent(bent, rate);
  const auto fit = fit_rectangle(from_above(points, surface), config);
  if (!fit) return {std::nullopt, "a level surface, but no two adjacent sides of a rectangle"};
  if (wearer_inside(points, surface, *fit)) return {std::nullopt, "a level contour round the wearer, no table", true};
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
  constexpr double kWindow = 0.05, kAlong = 0.95;  // m; cosine
  const auto travel = travel_directions(flat, kWindow);
  double level = 0.0, plumb = 0.0, total = 0.0;
  for (std::size_t i = 1; i < flat.size(); ++i) {
    const double step = (flat[i] - flat[i - 1]).norm();
    total += step;
    if (std::abs(travel[i].x()) > kAlong) level += step;
    if (std::abs(travel[i].y()) > kAlong) plumb += step;
  }
  return level + plumb > kMostOfIt * total && level > kMostOfIt * fit.size[0] && plumb > kMostOfIt * fit.size[1] &&
         std::max(fit.size[0], fit.size[1]) < kLongestPart && fit.size[1] > 0.25 * fit.size[0];
}

Attempt screen(std::span<const TracePoint> points, const Surface& surface, const LandmarkConfig& config) {
  const double heading = std::atan2(surface.normal.y(), surface.normal.x());
  const Eigen::Vector3d u(-std::sin(heading), std::cos(heading), 0.0);
  const Eigen::Vector3d foot = surface.offset * surface.normal;
  const auto flat = in_plane(points, surface, foot, u, Eigen::Vector3d::UnitZ());
  const auto fit = fit_rectangle(flat, config, 0.0);
  constexpr const char* kNeither = "an upright surface, but no closed contour and too short for a wall";
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
  Observation seen;
  seen.landmark.kind = LandmarkKind::Screen;
  const Eigen::Vector3d centre = foot + fit->centre.x() * u + fit->centre.y() * Eigen::Vector3d::UnitZ();
  seen.landmark.x = {centre.x(), centre.y(), centre.z(), heading, fit->size[0], fit->size[1], 0.0};
  seen.contacts = surface.members;
  seen.labels = fit->labels;
  seen.closed = fit->closed;
  return {seen, {}};
}

/// A straight line at one height, as low as tables are: one edge of a table as likely as a wall.
bool may_be_table_edge(std::span<const TracePoint> points, const Surface& surface, double floor_z, double length) {
  constexpr double kHighest = 0.95, kLongest = 2.5, kSpread = 0.04;  // m
  std::vector<double> heights, off;
  for (const std::size_t i : surface.members) heights.push_back(points[i].p.z() - floor_z);
  const double height = median(heights);
  for (const double h : heights) off.push_back(std::abs(h - height));
  return height < kHighest && length < kLongest && 1.48 * median(std::move(off)) < kSpread;
}

Attempt wall(std::span<const TracePoint> points, const Surface& surface, double floor_z, const LandmarkConfig& config) {
  const Eigen::Vector3d along(-surface.normal.y(), surface.normal.x(), 0.0);
  const double apart = std::abs(along.dot(points[surface.members.back()].p - points[surface.members.front()].p));
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (const std::size_t i : surface.members) {
    lo = std::min(lo, along.dot(points[i].p));
    hi = std::max(hi, along.dot(points[i].p));
  }
  // First and last contact far apart (paper, section IV): a hand that waves to and fro in the air does not get
  // anywhere.
  if (apart < config.wall_min_extent_m || apart < 0.4 * (hi - lo))
    return {std::nullopt, "an upright surface, but no closed contour and too short for a wall"};
  if (may_be_table_edge(points, surface, floor_z, hi - lo))
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
  return contour.observation || contour.part_of_screen ? contour : wall(points, surface, floor_z, config);
}

void shift(Observation& observation, std::size_t by) {
  for (auto& index : observation.contacts) index += by;
}

/// Looks for objects in points[begin, end), then in what is left of it before and after: one gesture may go from one
/// wall to the next.
void extract_range(std::span<const TracePoint> points, IndexRange range, double floor_z, const LandmarkConfig& config,
                   int depth, Extraction& out) {
  const auto part = points.subspan(range.begin, range.end - range.begin);
  if (part.size() < 8) {
    if (depth == 0) out.reason = "too few contacts";
    return;
  }
  // What is left beside an object is mostly the way to it; another object takes a while to draw.
  if (depth > 0 && part.back().time_s - part.front().time_s < kMinLeftover) return;
  const auto surfaces = find_surfaces(part, config);
  if (surfaces.empty()) {
    if (depth == 0) out.reason = "the hand did not stay on one surface";
    return;
  }
  std::size_t first = range.begin + surfaces[0].members.front(), last = range.begin + surfaces[0].members.back();
  bool round_wearer = false;
  for (const Surface& surface : surfaces) {
    // One long edge of a table is no wall beside it, even where the table could not be made out.
    if (&surface != &surfaces[0] && surface.share < kSecondChoice && !round_wearer) break;
    auto attempt = classify(part, surface, floor_z, config);
    if (attempt.observation) {
      shift(*attempt.observation, range.begin);
      first = attempt.observation->contacts.front(), last = attempt.observation->contacts.back();
      out.observations.push_back(std::move(*attempt.observation));
      break;
    }
    if (depth == 0 && out.reason.empty()) out.reason = attempt.reason;
    round_wearer = attempt.round_wearer;
  }
  if (depth >= kDeepest) return;
  extract_range(points, {range.begin, first}, floor_z, config, depth + 1, out);
  extract_range(points, {last + 1, range.end}, floor_z, config, depth + 1, out);
}

/// The one object that nearly all of points[begin, end) were drawn on, if there is one.
std::optional<Observation> single_object(std::span<const TracePoint> points, IndexRange range, double floor_z,
                                         const LandmarkConfig& config) {
  Extraction found;
  extract_range(points, range, floor_z, config, kNoLeftovers, found);
  if (found.observations.size() != 1) return std::nullopt;
  const auto explained = static_cast<double>(found.observations[0].contacts.size());
  if (explained < kMostOfAPart * static_cast<double>(range.end - range.begin)) return std::nullopt;
  return std::move(found.observations[0]);
}

/// Two edges of a table, seen from outside its corner, look like two walls; walls at that height surround the wearer.
bool may_be_table_corner(std::span<const TracePoint> points, const Observation& a, const Observation& b,
                         double floor_z) {
  if (a.landmark.kind != LandmarkKind::Wall || b.landmark.kind != LandmarkKind::Wall) return false;
  const auto middle = [&](const Observation& wall) { return points[wall.contacts[wall.contacts.size() / 2]].p; };
  const auto before = [&](const Observation& wall, const Eigen::Vector3d& p) {
    const double heading = wall.landmark.x[0];
    return Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0).dot(p - wall.landmark.anchor) > 0.0;
  };
  return std::max(middle(a).z(), middle(b).z()) - floor_z < kHighestEdge &&
         !(before(a, middle(b)) && before(b, middle(a)));
}

/// A gesture over two objects one after the other, of which neither stands out in the whole: two walls touched at one
/// height look like a level surface, two screens like none. Tries cuts in time; both parts must be objects by
/// themselves.
std::vector<Observation> two_objects(std::span<const TracePoint> points, IndexRange range, double floor_z,
                                     const LandmarkConfig& config) {
  std::vector<Observation> best;
  std::size_t most = 0;
  double next_s = points[range.begin].time_s + kMinLeftover;
  for (std::size_t cut = range.begin; cut < range.end; ++cut) {
    if (points[cut].time_s < next_s) continue;
    if (points[range.end - 1].time_s - points[cut].time_s < kMinLeftover) break;
    next_s = points[cut].time_s + kCutStep;
    auto before = single_object(points, {range.begin, cut}, floor_z, config);
    if (!before) continue;
    auto after = single_object(points, {cut, range.end}, floor_z, config);
    if (!after || may_be_table_corner(points, *before, *after, floor_z)) continue;
    const std::size_t explained = before->contacts.size() + after->contacts.size();
    if (explained <= most) continue;
    most = explained;
    best = {std::move(*before), std::move(*after)};
  }
  return best;
}

}  // namespace

Extraction extract_landmarks(std::span<const TracePoint> points, double floor_z, const LandmarkConfig& config) {
  Extraction out;
  const IndexRange drawn = without_reach(points, config);
  extract_range(points, drawn, floor_z, config, 0, out);
  if (out.observations.empty() && drawn.end > drawn.begin)
    out.observations = two_objects(points, drawn, floor_z, config);
  if (!out.observations.empty()) out.reason.clear();
  return out;
}

}  // namespace kinemap
