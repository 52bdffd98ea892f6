// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/svg.hpp"

#include <cmath>

#include "tools/kinemap/text_table.hpp"

namespace kinemap::bench {
namespace {

std::string escaped(const std::string& words) {
  std::string out;
  for (const char c : words) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else
      out += c;
  }
  return out;
}

std::string attributes(const Svg::Stroke& stroke) {
  std::string out = format(" stroke=\"%s\" stroke-width=\"%g\"", stroke.colour, stroke.width);
  if (*stroke.dashes) out += format(" stroke-dasharray=\"%s\"", stroke.dashes);
  if (stroke.opacity < 1.0) out += format(" stroke-opacity=\"%g\"", stroke.opacity);
  return out;
}

std::string list(const std::vector<Eigen::Vector2d>& points) {
  std::string out;
  for (const Eigen::Vector2d& p : points) out += format("%s%.1f,%.1f", out.empty() ? "" : " ", p.x(), p.y());
  return out;
}

}  // namespace

Svg::Svg(double width, double height, const std::string& title) {
  out_ = format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
      "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n",
      width, height, width, height);
  out_ += "<title>" + escaped(title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
}

void Svg::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Stroke& stroke) {
  out_ += format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"%s/>\n", a.x(), a.y(), b.x(), b.y(),
                 attributes(stroke).c_str());
}

void Svg::polyline(const std::vector<Eigen::Vector2d>& points, const Stroke& stroke) {
  out_ += format("<polyline fill=\"none\" stroke-linejoin=\"round\" points=\"%s\"%s/>\n", list(points).c_str(),
                 attributes(stroke).c_str());
}

void Svg::polygon(const std::vector<Eigen::Vector2d>& points, const char* fill, const Stroke& stroke) {
  out_ += format("<polygon fill=\"%s\" points=\"%s\"%s/>\n", fill, list(points).c_str(), attributes(stroke).c_str());
}

void Svg::box(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const char* fill, double opacity) {
  const Eigen::Vector2d corner = low.cwiseMin(high), extent = (high - low).cwiseAbs();
  out_ += format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"%s/>\n", corner.x(), corner.y(),
                 extent.x(), extent.y(), fill, opacity < 1.0 ? format(" fill-opacity=\"%g\"", opacity).c_str() : "");
}

void Svg::dot(const Eigen::Vector2d& centre, double radius, const char* fill, const Stroke& stroke) {
  out_ += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%g\" fill=\"%s\"%s/>\n", centre.x(), centre.y(), radius, fill,
                 attributes(stroke).c_str());
}

void Svg::text(const Eigen::Vector2d& at, const std::string& words, const Font& font) {
  out_ += format("<text x=\"%.1f\" y=\"%.1f\" font-size=\"%g\" fill=\"%s\" text-anchor=\"%s\"", at.x(), at.y(),
                 font.size, font.colour, font.anchor);
  if (font.bold) out_ += " font-weight=\"bold\"";
  if (font.halo) out_ += " paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\"";
  if (font.turn_deg != 0.0) out_ += format(" transform=\"rotate(%g %.1f %.1f)\"", font.turn_deg, at.x(), at.y());
  out_ += format(">%s</text>\n", escaped(words).c_str());
}

double nice_step(double range, int count) {
  const double rough = std::max(range, 1e-9) / count, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * 0.999) return factor * power;
  return 10.0 * power;
}

}  // namespace kinemap::bench
