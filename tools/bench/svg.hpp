// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace kinemap::bench {

/// Okabe and Ito's colours, which people with any colour vision tell apart.
namespace colour {
inline constexpr const char* kInk = "#222222";
inline constexpr const char* kFaint = "#6b6b6b";
inline constexpr const char* kGrid = "#dddddd";
inline constexpr const char* kGrey = "#9a9a9a";
inline constexpr const char* kBlue = "#0072b2";
inline constexpr const char* kSky = "#56b4e9";
inline constexpr const char* kGreen = "#009e73";
inline constexpr const char* kOrange = "#e69f00";
inline constexpr const char* kVermilion = "#d55e00";
inline constexpr const char* kPurple = "#a4508b";
}  // namespace colour

/// A picture in the making; pixels, y downwards. White ground, so that it is readable on dark pages too.
class Svg {
 public:
  Svg(double width, double height, const std::string& title);

  struct Stroke {
    const char* colour = colour::kInk;
    double width = 1.0;
    const char* dashes = "";
    double opacity = 1.0;
  };
  struct Font {
    double size = 13.0;
    const char* colour = colour::kInk;
    const char* anchor = "start";  ///< start, middle, end
    bool bold = false;
    bool halo = false;  ///< white rim, for text over lines
    double turn_deg = 0.0;
  };

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Stroke& stroke);
  void polyline(const std::vector<Eigen::Vector2d>& points, const Stroke& stroke);
  void polygon(const std::vector<Eigen::Vector2d>& points, const char* fill, const Stroke& stroke);
  void box(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const char* fill, double opacity = 1.0);
  void dot(const Eigen::Vector2d& centre, double radius, const char* fill, const Stroke& stroke);
  void text(const Eigen::Vector2d& at, const std::string& words, const Font& font);

  [[nodiscard]] std::string str() const { return out_ + "</svg>\n"; }

 private:
  std::string out_;
};

/// A step of 1, 2 or 5 × 10ⁿ of which about `count` make up `range`.
double nice_step(double range, int count);

}  // namespace kinemap::bench
