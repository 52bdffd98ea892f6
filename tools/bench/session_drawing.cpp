// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/session_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/bench/svg.hpp"
#include "tools/kinemap/alignment.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

using Point = Eigen::Vector2d;

constexpr double kWidth = 860.0, kMargin = 44.0, kMaxHeight = 720.0, kFooter = 74.0;
constexpr const char* kMark = "#f7e06e";
constexpr double kSeatHalfSide = 0.21;  // m, for drawing: only the middle of a seat is known

const char* colour_of(ObjectType type) {
  constexpr const char* kColours[] = {colour::kInk, colour::kVermilion, colour::kPurple, colour::kGreen};
  return kColours[static_cast<std::size_t>(type)];
}

/// Seen from above: a closed outline, or one stroke for what stands upright. In the frame of `T`.
std::vector<Point> outline_of(ObjectType type, const Pose& pose, const std::array<double, 2>& size) {
  const auto at = [&](double x, double y) { return Point((pose * Eigen::Vector3d(x, y, 0)).head<2>()); };
  const double u = size[0] / 2, v = size[1] / 2, s = kSeatHalfSide;
  if (type == ObjectType::Chair) return {at(-s, -s), at(s, -s), at(s, s), at(-s, s)};
  if (type == ObjectType::Table) return {at(-u, -v), at(u, -v), at(u, v), at(-u, v)};
  return {at(0, -u), at(0, u)};  // +x is the normal
}

/// The width of what stands upright is level; a screen that is higher than wide gives its height first.
std::array<double, 2> level_first(const MapObject& object) {
  std::array<double, 2> size = object.size.value_or(std::array<double, 2>{});
  if (object.type != ObjectType::Screen || !object.corners) return size;
  double width = 0.0;
  for (const Eigen::Vector3d& a : *object.corners)
    for (const Eigen::Vector3d& b : *object.corners) width = std::max(width, (a - b).head<2>().norm());
  return {width, 0.0};
}

/// Points nearer than 4 cm to the one before say nothing new at this scale.
std::vector<Point> thinned(const std::vector<Point>& path) {
  std::vector<Point> out;
  for (const Point& p : path)
    if (out.empty() || (p - out.back()).norm() > 0.04) out.push_back(p);
  return out;
}

class Drawing {
 public:
  Drawing(const Session& session, std::optional<std::uint32_t> culprit) : session_(session), culprit_(culprit) {
    turn_ = level_pose(Eigen::Vector3d::Zero(), -main_heading());
    collect_paths();
    measure();
    if ((high_ - low_).y() > (high_ - low_).x()) {
      turn_ = level_pose(Eigen::Vector3d::Zero(), std::numbers::pi / 2) * turn_;
      measure();
    }
  }

  std::string svg() {
    const Point extent = high_ - low_;
    scale_ = std::min((kWidth - 2 * kMargin) / extent.x(), (kMaxHeight - 2 * kMargin) / extent.y());
    left_ = (kWidth - scale_ * extent.x()) / 2;
    bottom_ = kMargin + scale_ * extent.y();
    Svg svg(kWidth, bottom_ + kMargin / 2 + kFooter, "Truth and map of a simulated session");
    for (const auto& room : truth().rooms) svg.polygon(pixels(room), "#f5f5f3", {.colour = "#f5f5f3"});
    if (culprit_) mark(svg);
    for (const eval::TruthObject& object : truth().objects) draw_true(svg, object, false);
    for (const eval::TruthObject& object : truth().untouched) draw_true(svg, object, true);
    svg.polyline(pixels(thinned(true_path_)), {.colour = colour::kGrey, .width = 1.3});
    svg.polyline(pixels(thinned(open_path_)), {.colour = colour::kOrange, .width = 1, .dashes = "4 3", .opacity = 0.8});
    svg.polyline(pixels(thinned(map_path_)), {.colour = colour::kSky, .width = 1.3, .opacity = 0.9});
    for (const MapObject& object : session_.map->objects) draw_estimated(svg, object);
    footer(svg);
    return svg.str();
  }

 private:
  [[nodiscard]] const eval::Truth& truth() const { return *session_.truth; }

  /// The truth's walls are drawn level and upright.
  [[nodiscard]] double main_heading() const {
    double c = 0.0, s = 0.0;
    for (const auto& room : truth().rooms)
      for (std::size_t i = 0; i < room.size(); ++i) {
        const Point side = room[(i + 1) % room.size()] - room[i];
        const double heading = std::atan2(side.y(), side.x());
        c += side.norm() * std::cos(4 * heading);
        s += side.norm() * std::sin(4 * heading);
      }
    return std::atan2(s, c) / 4;
  }

  void collect_paths() {
    std::vector<Eigen::Vector3d> odometry, real;
    for (const TrajectoryPose& pose : session_.map->trajectory) {
      const auto T_truth_pelvis = eval::pose_at(truth().trajectory, pose.time_s);
      if (!T_truth_pelvis) continue;
      odometry.push_back(pose.T_odom_pelvis.p);
      real.push_back(T_truth_pelvis->p);
      map_path_.emplace_back((session_.evaluation.T_truth_map * pose.T_map_pelvis.p).head<2>());
    }
    const Pose T_truth_odom = eval::align(odometry, real).value_or(Pose{});
    for (const Eigen::Vector3d& p : odometry) open_path_.emplace_back((T_truth_odom * p).head<2>());
    for (const TimedPose& pose : truth().trajectory) true_path_.emplace_back(pose.pose.p.head<2>());
  }

  void measure() {
    low_ = Point::Constant(HUGE_VAL), high_ = -low_;
    const auto take = [&](const Point& p) { low_ = low_.cwiseMin(turned(p)), high_ = high_.cwiseMax(turned(p)); };
    for (const auto& room : truth().rooms) std::for_each(room.begin(), room.end(), take);
    for (const auto* path : {&true_path_, &map_path_, &open_path_}) std::for_each(path->begin(), path->end(), take);
    for (const MapObject& object : session_.map->objects)
      for (const Point& p : outline(object)) take(p);
  }

  [[nodiscard]] Point turned(const Point& p) const { return (turn_ * Eigen::Vector3d(p.x(), p.y(), 0.0)).head<2>(); }
  [[nodiscard]] Point pixel(const Point& p) const {
    const Point q = turned(p);
    return {left_ + (q.x() - low_.x()) * scale_, bottom_ - (q.y() - low_.y()) * scale_};
  }
  [[nodiscard]] std::vector<Point> pixels(const std::vector<Point>& points) const {
    std::vector<Point> out;
    for (const Point& p : points) out.push_back(pixel(p));
    return out;
  }
  [[nodiscard]] std::vector<Point> outline(const MapObject& object) const {
    return outline_of(object.type, session_.evaluation.T_truth_map * object.pose, level_first(object));
  }

  void draw_true(Svg& svg, const eval::TruthObject& object, bool untouched) const {
    const auto shape = pixels(outline_of(object.type, object.pose, object.size));
    const Svg::Stroke stroke{
        .colour = "#bcbcbc", .width = shape.size() == 2 ? 7.0 : 2.0, .dashes = untouched ? "3 4" : ""};
    if (shape.size() == 2) return svg.line(shape[0], shape[1], stroke);
    svg.polygon(shape, object.type == ObjectType::Table ? "#e2e2e0" : "none", stroke);
  }

  void draw_estimated(Svg& svg, const MapObject& object) const {
    const auto contains = [&](const std::vector<std::uint32_t>& ids) {
      return std::find(ids.begin(), ids.end(), object.id) != ids.end();
    };
    const bool bad = contains(session_.evaluation.spurious) || contains(session_.evaluation.duplicates);
    const auto shape = pixels(outline(object));
    const Svg::Stroke stroke{
        .colour = colour_of(object.type), .width = shape.size() == 2 ? 3.0 : 2.0, .dashes = bad ? "6 4" : ""};
    if (shape.size() == 2)
      svg.line(shape[0], shape[1], stroke);
    else
      svg.polygon(shape, "none", stroke);
    Point at = Point::Zero();
    for (const Point& p : shape) at += p / static_cast<double>(shape.size());
    const char letter = "WTSC"[static_cast<std::size_t>(object.type)];
    svg.text(at + Point(0, 4), format("%c%u%s", letter, object.id, bad ? "?" : ""),
             {.size = 12, .colour = stroke.colour, .anchor = "middle", .bold = true, .halo = true});
  }

  /// Underlines the true object that the picture is about.
  void mark(Svg& svg) const {
    for (const eval::TruthObject& object : truth().objects) {
      if (object.id != *culprit_) continue;
      auto shape = pixels(outline_of(object.type, object.pose, object.size));
      shape.push_back(shape.front());
      svg.polyline(shape, {.colour = kMark, .width = 22});
    }
  }

  void footer(Svg& svg) const {
    double y = bottom_ + kMargin / 2 + 24;
    double x = kMargin;
    const auto entry = [&](const Svg::Stroke& stroke, const char* words) {
      svg.line({x, y - 4}, {x + 26, y - 4}, stroke);
      svg.text({x + 32, y}, words, {});
      x += 52 + 7.2 * static_cast<double>(cli::display_width(words));
    };
    entry({.colour = "#bcbcbc", .width = 7}, "truth");
    entry({.colour = "#bcbcbc", .width = 7, .dashes = "3 4"}, "never touched");
    entry({.colour = colour_of(ObjectType::Wall), .width = 3}, "wall");
    entry({.colour = colour_of(ObjectType::Table), .width = 2}, "table");
    entry({.colour = colour_of(ObjectType::Screen), .width = 3}, "screen");
    entry({.colour = colour_of(ObjectType::Chair), .width = 2}, "chair");
    svg.line({kWidth - kMargin - scale_, y - 4}, {kWidth - kMargin, y - 4}, {.width = 2});
    svg.text({kWidth - kMargin - scale_ / 2, y - 10}, "1 m", {.size = 12, .anchor = "middle"});
    x = kMargin;
    y += 26;
    entry({.colour = colour::kGrey, .width = 1.6}, "true path");
    entry({.colour = colour::kOrange, .width = 1.4, .dashes = "4 3"}, "the suit's, aligned");
    entry({.colour = colour::kSky, .width = 1.8}, "optimised path");
    entry({.colour = colour::kInk, .width = 2, .dashes = "6 4"}, "false or double (?)");
    if (culprit_) entry({.colour = kMark, .width = 14}, "this one");
  }

  const Session& session_;
  std::optional<std::uint32_t> culprit_;
  Pose turn_;  ///< from the frame of the truth to that of the page
  std::vector<Point> true_path_, open_path_, map_path_;
  Point low_{0, 0}, high_{0, 0};
  double scale_ = 1.0, left_ = 0.0, bottom_ = 0.0;
};

}  // namespace

std::string session_svg(const Session& session, std::optional<std::uint32_t> culprit) {
  return Drawing(session, culprit).svg();
}

}  // namespace kinemap::bench
