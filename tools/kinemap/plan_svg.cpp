// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/kinemap/plan.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

constexpr double kPixelsPerMetre = 90.0;
constexpr double kMargin = 70.0;
constexpr double kFooter = 60.0;

constexpr const char* kStyle = R"(<style>
  text { font-family: 'DejaVu Sans', Helvetica, Arial, sans-serif; font-size: 12px; fill: #333 }
  .room { fill: #f4f1ea }
  .path { fill: none; stroke: #e2611c; stroke-width: 1; stroke-opacity: .45; stroke-linejoin: round }
  .wall { stroke: #2c3440; stroke-width: 5; stroke-linecap: square }
  .table { fill: #d9b88f; stroke: #8a5a24; stroke-width: 1.5 }
  .screen { stroke: #1d6fa5; stroke-width: 6 }
  .chair { fill: #9cc9a3; stroke: #2f7a3d; stroke-width: 1.5 }
  .front { stroke: #2f7a3d; stroke-width: 2.5 }
  .size { font-size: 11px; fill: #666 }
  .halo { paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round }
</style>
)";

class Drawing {
 public:
  explicit Drawing(const Plan& plan) : plan_(plan) {}

  std::string svg() {
    const Eigen::Vector2d extent = (plan_.high - plan_.low) * kPixelsPerMetre;
    width_ = std::max(extent.x(), 300.0) + 2 * kMargin;
    height_ = extent.y() + 2 * kMargin + kFooter;
    out_ =
        format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\">\n",
               width_, height_, width_, height_);
    out_ += "<title>Kinemap floor plan</title>\n";
    out_ += kStyle;
    out_ += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    for (const auto& room : plan_.rooms) polygon(room, "room");
    path();
    for (const Plan::Item& item : plan_.items) shape(item);
    for (std::size_t i = 0; i < plan_.rooms.size(); ++i) room_label(i);
    for (const Plan::Item& item : plan_.items) label(item);
    footer();
    return out_ + "</svg>\n";
  }

 private:
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& p) const {
    return {kMargin + (p.x() - plan_.low.x()) * kPixelsPerMetre, kMargin + (plan_.high.y() - p.y()) * kPixelsPerMetre};
  }

  [[nodiscard]] std::string points(const std::vector<Eigen::Vector2d>& line) const {
    std::string text;
    for (const Eigen::Vector2d& p : line) text += format("%.1f,%.1f ", pixel(p).x(), pixel(p).y());
    return text;
  }

  void polygon(const std::vector<Eigen::Vector2d>& corners, const char* style) {
    out_ += format("<polygon class=\"%s\" points=\"%s\"/>\n", style, points(corners).c_str());
  }

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style) {
    const Eigen::Vector2d p = pixel(a), q = pixel(b);
    out_ += format("<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", style, p.x(), p.y(), q.x(),
                   q.y());
  }

  /// Text centred on a pixel, turned by `degrees` (clockwise on the page).
  void text(const Eigen::Vector2d& at, const std::string& words, const char* style, double degrees = 0.0) {
    out_ +=
        format("<text class=\"%s\" text-anchor=\"middle\" transform=\"translate(%.1f %.1f) rotate(%.1f)\">%s</text>\n",
               style, at.x(), at.y() + (degrees == 0.0 ? 4.0 : 0.0), degrees, words.c_str());
  }

  void path() {
    if (plan_.path.size() < 2) return;
    out_ += format("<polyline class=\"path\" points=\"%s\"/>\n", points(plan_.path).c_str());
  }

  void shape(const Plan::Item& item) {
    const char* style = to_string(item.type);
    if (item.outline.size() == 2) return line(item.outline[0], item.outline[1], style);
    polygon(item.outline, style);
    if (item.type == ObjectType::Chair) line(item.centre, item.centre + 0.32 * item.front, "front");
  }

  void label(const Plan::Item& item) {
    const std::string name = plan_letter(item.type) + std::to_string(item.id);
    const Eigen::Vector2d at = pixel(item.centre);
    if (item.type == ObjectType::Chair) return text(pixel(item.centre - 0.1 * item.front), name, "halo");
    if (item.type == ObjectType::Table && carries_screen(item))
      return text(below(item), name + "  " + item.size, "size halo");
    if (item.type == ObjectType::Table) {
      text(at - Eigen::Vector2d(0, 7), name, "halo");
      return text(at + Eigen::Vector2d(0, 8), item.size, "size halo");
    }
    stroke_label(item, name + "  " + item.size);
  }

  /// A screen in the middle of a table leaves no room for the table's own label.
  [[nodiscard]] bool carries_screen(const Plan::Item& table) const {
    return std::any_of(plan_.items.begin(), plan_.items.end(), [&](const Plan::Item& other) {
      if (other.type != ObjectType::Screen) return false;
      return (other.centre - table.centre).norm() < 0.6 * (table.outline[0] - table.centre).norm();
    });
  }

  /// A point on the page just below an outline.
  [[nodiscard]] Eigen::Vector2d below(const Plan::Item& item) const {
    double y = 0.0;
    for (const Eigen::Vector2d& corner : item.outline) y = std::max(y, pixel(corner).y());
    return {pixel(item.centre).x(), y + 12.0};
  }

  /// Along a wall on its outer side; along a screen in front of it, where the wall's own label is not.
  void stroke_label(const Plan::Item& item, const std::string& words) {
    const Eigen::Vector2d along = item.outline[1] - item.outline[0];
    double degrees = -std::atan2(along.y(), along.x()) * 180.0 / std::numbers::pi;
    if (degrees > 90.5) degrees -= 180.0;
    if (degrees < -89.5) degrees += 180.0;
    const double sense = item.type == ObjectType::Wall ? -1.0 : 1.0;
    const Eigen::Vector2d side(sense * item.front.x(), -sense * item.front.y());  // y runs down on the page
    // The base line lies 4 px below the middle of the letters, seen along the turned text.
    const double radians = degrees * std::numbers::pi / 180.0;
    const Eigen::Vector2d drop = 4.0 * Eigen::Vector2d(-std::sin(radians), std::cos(radians));
    const Eigen::Vector2d middle = pixel((item.outline[0] + item.outline[1]) / 2);
    const Eigen::Vector2d at = middle + 14.0 * side + drop;
    text(degrees == 0.0 ? Eigen::Vector2d(at - Eigen::Vector2d(0, 4)) : at, words,
         item.type == ObjectType::Wall ? "halo" : "size halo", degrees);
  }

  void room_label(std::size_t i) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : plan_.rooms[i]) middle += corner / static_cast<double>(plan_.rooms[i].size());
    text(pixel(middle), plan_.room_labels[i], "size halo");
  }

  /// Scale bar, axes of the map frame.
  void footer() {
    const double y = height_ - 28.0, x = kMargin;
    out_ += format(
        "<path d=\"M%.1f %.1fv8h%.1fv-8m%.1f 0v4\" transform=\"translate(0 -8)\" fill=\"none\" stroke=\"#333\" "
        "stroke-width=\"1.5\"/>\n",
        x, y, 2 * kPixelsPerMetre, -kPixelsPerMetre);
    text({x, y + 12}, "0", "size");
    text({x + kPixelsPerMetre, y + 12}, "1", "size");
    text({x + 2 * kPixelsPerMetre, y + 12}, "2 m", "size");
    const Eigen::Vector2d origin(width_ - kMargin, height_ - 60.0);
    for (const auto& [name, heading] :
         {std::pair{"x", plan_.turn_rad}, std::pair{"y", plan_.turn_rad + std::numbers::pi / 2}}) {
      const Eigen::Vector2d direction(std::cos(heading), -std::sin(heading)), tip = origin + 24.0 * direction;
      out_ += format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#333\"/>\n", origin.x(),
                     origin.y(), tip.x(), tip.y());
      text(origin + 33.0 * direction, name, "size");
    }
  }

  const Plan& plan_;
  std::string out_;
  double width_ = 0.0, height_ = 0.0;
};

}  // namespace

std::string plan_svg(const Plan& plan) { return Drawing(plan).svg(); }

}  // namespace kinemap::cli
