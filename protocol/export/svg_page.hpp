// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kinemap {

/// A page of an SVG picture with labels that keep out of each other's way. Metres of a plan (y up) become pixels (y
/// down); what is said in pixels stays so.
class SvgPage {
 public:
  static constexpr double kPixelsPerMetre = 90.0;

  /// Where a label may stand: its middle (pixels) and its turn (degrees, clockwise on the page).
  struct Spot {
    Eigen::Vector2d at;
    double degrees = 0.0;
  };

  /// A page that shows low … high (m), with margins (pixels) round it.
  SvgPage(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double margin, double footer);

  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& p) const;
  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }

  /// SVG as it is.
  void raw(const std::string& svg) { body_ += svg; }
  /// Shapes in metres; `title`: shown where the pointer rests.
  void polygon(const std::vector<Eigen::Vector2d>& corners, const char* style, const std::string& title = {});
  void polyline(const std::vector<Eigen::Vector2d>& points, const char* style);
  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style, const std::string& title = {});
  /// A line in pixels.
  void stroke(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style);
  void text(const std::vector<std::string>& lines, const char* style, const Spot& spot);

  /// Labels keep away from what is reserved: the way from a to b, or the box round the corners (m). `owner` marks what
  /// the owner's own label may cover.
  void reserve_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const void* owner = nullptr);
  void reserve_box(const std::vector<Eigen::Vector2d>& corners, const void* owner = nullptr);
  /// Pixels² of reserved space under a label, or what is beyond the page's edge.
  [[nodiscard]] double crowding(const std::vector<std::string>& lines, const Spot& spot,
                                const void* owner = nullptr) const;
  /// Writes the label at the spot that is least crowded, the earlier the better, and reserves it. The spot; there must
  /// be one to choose from.
  Spot label(const std::vector<std::string>& lines, const char* style, const std::vector<Spot>& spots,
             const void* owner = nullptr);

  /// About how wide a line of text is, pixels.
  [[nodiscard]] static double text_width(const std::string& line);

  [[nodiscard]] const std::string& body() const { return body_; }

 private:
  struct Box {
    Eigen::Vector2d low, high;
    const void* owner = nullptr;
  };
  [[nodiscard]] static Box box_of(const std::vector<std::string>& lines, const Spot& spot);
  [[nodiscard]] std::string points(const std::vector<Eigen::Vector2d>& line) const;

  Eigen::Vector2d low_, high_;
  double margin_, width_, height_;
  std::string body_;
  void take(const Box& box);
  /// A function of each pair of numbers (column, row) of the squares of the page that a box touches.
  template <class Visit>
  static void squares(const Box& box, Visit visit);
  std::map<std::pair<int, int>, std::vector<Box>> taken_;  // by square: large plans have many boxes
};

}  // namespace kinemap
