// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/mapper/polygon.hpp"
#include "protocol/export/plan.hpp"
#include "protocol/export/svg_page.hpp"
#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

using Spot = SvgPage::Spot;

constexpr double kMargin = 80.0;
constexpr double kFooter = 84.0;
constexpr double kDimensionOffset = 26.0;  // pixels from a wall's face to its dimension line
constexpr double kWidestPrintMm = 400.0;   // A3 across

constexpr const char* kStyle = R"(<style>
  text { font: 12px 'DejaVu Sans', Helvetica, Arial, sans-serif; fill: #2c3440; text-anchor: middle;
    paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round }
  .room { fill: #f4f1ea }
  .area { font-weight: bold }
  .path { fill: none; stroke: #e2611c; stroke-width: 1; stroke-opacity: .35; stroke-linejoin: round }
  .wall { fill: #2c3440; stroke: #2c3440; stroke-width: 1; stroke-linejoin: miter }
  .inferred { fill: none; stroke: #8b93a1; stroke-width: 2; stroke-dasharray: 6 5 }
  .doorway { stroke: #8b93a1; stroke-width: 1; stroke-dasharray: 2 3 }
  .jamb, .dimension { stroke: #5a6473; stroke-width: 1 }
  .table { fill: #e3c9a4; stroke: #8a5a24; stroke-width: 1.5 }
  .screen { stroke: #1d6fa5; stroke-width: 5 }
  .chair { fill: #b4d8b9; stroke: #2f7a3d; stroke-width: 1.5 }
  .front { stroke: #2f7a3d; stroke-width: 2 }
  .note { font-size: 11px; fill: #5a6473; text-anchor: start }
  .tick { font-size: 11px; fill: #5a6473 }
  .bar { fill: #2c3440; stroke: #2c3440; stroke-width: 1 }
  .gap { fill: #fff; stroke: #2c3440; stroke-width: 1 }
</style>
)";

/// A direction of the plan (y up) on the page (y down).
Eigen::Vector2d down(const Eigen::Vector2d& direction) { return {direction.x(), -direction.y()}; }

/// The turn (degrees, clockwise on the page) that lets text run along a direction of the plan and be read from below or
/// from the right.
double readable(const Eigen::Vector2d& along) {
  double degrees = -std::atan2(along.y(), along.x()) * 180.0 / std::numbers::pi;
  if (degrees > 89.5) degrees -= 180.0;
  if (degrees < -90.5) degrees += 180.0;
  return degrees;
}

class Drawing {
 public:
  explicit Drawing(const Plan& plan) : plan_(plan), page_(plan.low, plan.high, kMargin, kFooter) {
    for (const Plan::Item& item : plan.items) details_[item.id] = item.detail;
  }

  std::string svg() {
    for (const Plan::Floor& room : plan_.rooms) page_.polygon(room.polygon, "room");
    if (plan_.path.size() > 1) page_.polyline(plan_.path, "path");
    for (const WallStretch& wall : plan_.walls) draw(wall);
    for (const Plan::Item& item : plan_.items) shape(item);
    for (const Plan::Item& item : plan_.items)
      if (item.type == ObjectType::Wall) dimension(item);
    for (const ObjectType type : {ObjectType::Chair, ObjectType::Screen, ObjectType::Table})
      for (const Plan::Item& item : plan_.items)
        if (item.type == type) label(item);
    for (const Plan::Floor& room : plan_.rooms) label(room);
    scale_bar();
    axes();
    notes();
    return head() + page_.body() + "</svg>\n";
  }

 private:
  /// The first usual scale at which the plan fits the paper.
  [[nodiscard]] double scale() const {
    for (const double s : {20.0, 50.0, 100.0, 200.0, 500.0})
      if (page_.width() / SvgPage::kPixelsPerMetre * 1000.0 / s <= kWidestPrintMm) return s;
    return 1000.0;
  }

  [[nodiscard]] std::string head() const {
    const double mm = 1000.0 / scale() / SvgPage::kPixelsPerMetre;
    return format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.2fmm\" "
               "height=\"%.2fmm\">\n<title>Kinemap floor plan</title>\n",
               page_.width(), page_.height(), mm * std::round(page_.width()), mm * std::round(page_.height())) +
           kStyle + "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  }

  void draw(const WallStretch& wall) {
    const Eigen::Vector2d back = -kWallThickness * wall.normal();
    page_.reserve_line(wall.a, wall.b);
    if (wall.open) {
      page_.line(wall.a, wall.b, "doorway");
      page_.line(wall.a + back, wall.b + back, "doorway");
      page_.line(wall.a, wall.a + back, "jamb");
      page_.line(wall.b, wall.b + back, "jamb");
    } else if (wall.wall_id == 0) {
      page_.line(wall.a, wall.b, "inferred", "inferred: nobody touched it, but there must be a wall");
    } else {
      const auto corners = wall.outline(kWallThickness);
      page_.polygon({corners.begin(), corners.end()}, "wall", details_[wall.wall_id]);
    }
  }

  void shape(const Plan::Item& item) {
    const char* style = to_string(item.type);
    if (item.type == ObjectType::Wall) return;
    if (item.outline.size() == 2) {
      page_.line(item.outline[0], item.outline[1], style, item.detail);
      return page_.reserve_line(item.outline[0], item.outline[1]);
    }
    page_.polygon(item.outline, style, item.detail);
    page_.reserve_box(item.outline, &item);
    if (item.type == ObjectType::Chair) page_.line(item.centre, item.centre + 0.3 * item.front, "front");
  }

  /// The wall's length on a dimension line: outside, unless something is there and inside there is not.
  void dimension(const Plan::Item& wall) {
    const Eigen::Vector2d a = page_.pixel(wall.outline[0]), b = page_.pixel(wall.outline[1]);
    const Eigen::Vector2d outside = -down(wall.front), inside = 0.8 * down(wall.front);
    const double degrees = readable(wall.outline[1] - wall.outline[0]);
    const std::string words = wall.name() + " · " + wall.size;
    // As if the label were as long as the line.
    const auto crowding = [&](const Eigen::Vector2d& side) {
      double sum = 0.0;
      for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9})
        sum += page_.crowding({"0000"}, {a + t * (b - a) + kDimensionOffset * side, degrees});
      return sum;
    };
    const Eigen::Vector2d offset = kDimensionOffset * (crowding(outside) <= crowding(inside) ? outside : inside);
    const Eigen::Vector2d along = (b - a).normalized(), tick = 4.0 * (along + offset.normalized());
    for (const Eigen::Vector2d& end : {a, b}) {
      page_.stroke(end + 0.3 * offset, end + 1.2 * offset, "dimension");
      page_.stroke(end + offset - tick, end + offset + tick, "dimension");
    }
    std::vector<Spot> spots;
    for (const double t : {0.5, 0.35, 0.65, 0.2, 0.8}) spots.push_back({a + t * (b - a) + offset, degrees});
    const Eigen::Vector2d middle = page_.label({words}, "thing", spots).at;
    const double half = SvgPage::text_width(words) / 2 + 4.0;
    for (const Eigen::Vector2d& end : {a, b}) {
      const double rest = (middle - end - offset).norm() - half;
      if (rest > 0.0)
        page_.stroke(end + offset, end + offset + rest * (middle - end - offset).normalized(), "dimension");
    }
  }

  void label(const Plan::Item& item) {
    const Eigen::Vector2d at = page_.pixel(item.centre);
    if (item.type == ObjectType::Screen) return stroke_label(item);
    std::vector<std::string> lines{item.name()};
    if (!item.size.empty()) lines.push_back(item.size);
    std::vector<Spot> spots{{at}};
    Eigen::Vector2d half(0.0, 0.0);
    for (const Eigen::Vector2d& corner : item.outline) half = half.cwiseMax((page_.pixel(corner) - at).cwiseAbs());
    for (const double reach : {0.5, 1.0})  // in a part of it, then beside it
      for (const Eigen::Vector2d& side : {Eigen::Vector2d(0, -1), {0, 1}, {-1, 0}, {1, 0}}) {
        const Eigen::Vector2d room = reach < 1.0 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(52, 20);
        spots.push_back({at + side.cwiseProduct(reach * half + room)});
      }
    page_.label(lines, "thing", spots, &item);
  }

  /// Along a screen, in front of it or behind.
  void stroke_label(const Plan::Item& item) {
    const Eigen::Vector2d middle = page_.pixel(item.centre);
    const double degrees = readable(item.outline[1] - item.outline[0]);
    std::vector<Spot> spots;
    for (const double away : {16.0, -16.0, 32.0, -32.0}) spots.push_back({middle + away * down(item.front), degrees});
    page_.label({item.name() + " · " + item.size}, "thing", spots);
  }

  /// In the room, as near its middle as there is space.
  void label(const Plan::Floor& room) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero(), low = room.polygon.front(), high = low;
    for (const Eigen::Vector2d& corner : room.polygon) {
      middle += corner / static_cast<double>(room.polygon.size());
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    std::vector<Eigen::Vector2d> inside;
    constexpr int kGrid = 24;
    for (int i = 1; i < kGrid; ++i)
      for (int j = 1; j < kGrid; ++j) {
        const Eigen::Vector2d p = low + (high - low).cwiseProduct(Eigen::Vector2d(i, j) / kGrid);
        if (contains(room.polygon, p)) inside.push_back(p);
      }
    std::stable_sort(inside.begin(), inside.end(), [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
      return (p - middle).norm() < (q - middle).norm();
    });
    std::vector<Spot> spots;
    for (const Eigen::Vector2d& p : inside) spots.push_back({page_.pixel(p)});
    if (spots.empty()) spots.push_back({page_.pixel(middle)});
    page_.label({format("Room %u", room.id), format("%.1f m²", room.area_m2)}, "area", spots);
  }

  /// A bar of 1, 2, 5, … m in halves.
  void scale_bar() {
    double metres = 2.0;
    for (const double longer : {5.0, 10.0, 20.0, 50.0, 100.0})
      if (longer < 0.3 * page_.width() / SvgPage::kPixelsPerMetre) metres = longer;
    const double half = metres / 2 * SvgPage::kPixelsPerMetre, y = page_.height() - 64.0;
    for (const int part : {0, 1})
      page_.raw(format("<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"5\"/>\n", part ? "gap" : "bar",
                       kMargin + part * half, y, half));
    const std::string names[] = {"0", format("%.4g", metres / 2), format("%.0f m", metres)};
    for (int i = 0; i < 3; ++i) page_.text({names[i]}, "tick", {{kMargin + i * half, y + 15.0}});
  }

  /// The axes of the map frame: nothing is known of where north is.
  void axes() {
    const Eigen::Vector2d origin(page_.width() - kMargin, page_.height() - 52.0);
    for (const auto& [name, heading] :
         {std::pair{"x", plan_.turn_rad}, std::pair{"y", plan_.turn_rad + std::numbers::pi / 2}}) {
      const Eigen::Vector2d along(std::cos(heading), -std::sin(heading)), across(-along.y(), along.x());
      const Eigen::Vector2d tip = origin + 28.0 * along;
      page_.stroke(origin, tip, "jamb");
      page_.stroke(tip, tip - 6.0 * along + 3.0 * across, "jamb");
      page_.stroke(tip, tip - 6.0 * along - 3.0 * across, "jamb");
      page_.text({name}, "tick", {origin + 37.0 * along});
    }
  }

  void notes() {
    std::string text = format("Kinemap, map revision %llu, 1 : %.0f, axes of the map frame",
                              static_cast<unsigned long long>(plan_.revision), scale());
    const auto has = [&](auto predicate) { return std::any_of(plan_.walls.begin(), plan_.walls.end(), predicate); };
    if (has([](const WallStretch& wall) { return wall.wall_id == 0; }))
      text += " · dashed walls: inferred, not touched · ≥: an end was not touched";
    if (has([](const WallStretch& wall) { return wall.open; }))
      text += format(" · doorways: width not known, drawn %.1f m", kDoorwayWidth);
    page_.text({text}, "note", {{kMargin, page_.height() - 20.0}});
  }

  const Plan& plan_;
  std::map<std::uint32_t, std::string> details_;  // by the object's id
  SvgPage page_;
};

}  // namespace

std::string plan_svg(const MapSnapshot& map) { return Drawing(make_plan(map)).svg(); }

}  // namespace kinemap
