// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/svg_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

constexpr double kLetterWidth = 7.0;  // pixels, on average, of the labels' 12 px type
constexpr double kLineHeight = 15.0;
constexpr double kSquare = 128.0;  // pixels
constexpr double kSampling = 8.0;  // pixels between the boxes that stand for a line

std::string title_of(const std::string& title) { return title.empty() ? "/>\n" : "><title>" + title + "</title>"; }

}  // namespace

SvgPage::SvgPage(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double margin, double footer)
    : low_(low),
      high_(high),
      margin_(margin),
      width_(std::max((high - low).x() * kPixelsPerMetre, 400.0) + 2 * margin),
      height_((high - low).y() * kPixelsPerMetre + 2 * margin + footer) {}

Eigen::Vector2d SvgPage::pixel(const Eigen::Vector2d& p) const {
  return {margin_ + (p.x() - low_.x()) * kPixelsPerMetre, margin_ + (high_.y() - p.y()) * kPixelsPerMetre};
}

std::string SvgPage::points(const std::vector<Eigen::Vector2d>& line) const {
  std::string text;
  for (const Eigen::Vector2d& p : line)
    text += format(text.empty() ? "%.1f,%.1f" : " %.1f,%.1f", pixel(p).x(), pixel(p).y());
  return text;
}

void SvgPage::polygon(const std::vector<Eigen::Vector2d>& corners, const char* style, const std::string& title) {
  body_ += format("<polygon class=\"%s\" points=\"%s\"", style, points(corners).c_str()) + title_of(title);
  if (!title.empty()) body_ += "</polygon>\n";
}

void SvgPage::polyline(const std::vector<Eigen::Vector2d>& way, const char* style) {
  body_ += format("<polyline class=\"%s\" points=\"%s\"/>\n", style, points(way).c_str());
}

void SvgPage::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style, const std::string& title) {
  const Eigen::Vector2d p = pixel(a), q = pixel(b);
  body_ +=
      format("<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"", style, p.x(), p.y(), q.x(), q.y()) +
      title_of(title);
  if (!title.empty()) body_ += "</line>\n";
}

void SvgPage::stroke(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style) {
  body_ += format("<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", style, a.x(), a.y(), b.x(),
                  b.y());
}

void SvgPage::text(const std::vector<std::string>& lines, const char* style, const Spot& spot) {
  // The middle of the letters lies 4 px above their base line.
  double y = 4.0 - 0.5 * kLineHeight * static_cast<double>(lines.size() - 1);
  for (const std::string& line : lines) {
    body_ +=
        format("<text class=\"%s\" transform=\"translate(%.1f %.1f)%s\" y=\"%.1f\">%s</text>\n", style, spot.at.x(),
               spot.at.y(), spot.degrees == 0.0 ? "" : format(" rotate(%.1f)", spot.degrees).c_str(), y, line.c_str());
    y += kLineHeight;
  }
}

double SvgPage::text_width(const std::string& line) {
  const auto letters = std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return kLetterWidth * static_cast<double>(letters);
}

SvgPage::Box SvgPage::box_of(const std::vector<std::string>& lines, const Spot& spot) {
  double width = 0.0;
  for (const std::string& line : lines) width = std::max(width, text_width(line));
  const double height = kLineHeight * static_cast<double>(lines.size());
  const double c = std::abs(std::cos(spot.degrees * std::numbers::pi / 180.0));
  const double s = std::abs(std::sin(spot.degrees * std::numbers::pi / 180.0));
  const Eigen::Vector2d half(0.5 * (c * width + s * height), 0.5 * (s * width + c * height));
  return {spot.at - half, spot.at + half};
}

void SvgPage::reserve_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const void* owner) {
  const Eigen::Vector2d p = pixel(a), way = pixel(b) - p, half(kSampling / 2, kSampling / 2);
  const int steps = std::max(1, static_cast<int>(way.norm() / kSampling));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = p + way * i / steps;
    take({at - half, at + half, owner});
  }
}

void SvgPage::reserve_box(const std::vector<Eigen::Vector2d>& corners, const void* owner) {
  Box box{pixel(corners.front()), pixel(corners.front()), owner};
  for (const Eigen::Vector2d& corner : corners) {
    box.low = box.low.cwiseMin(pixel(corner));
    box.high = box.high.cwiseMax(pixel(corner));
  }
  take(box);
}

template <class Visit>
void SvgPage::squares(const Box& box, Visit visit) {
  const Eigen::Array2d first = (box.low / kSquare).array().floor(), last = (box.high / kSquare).array().floor();
  for (int x = static_cast<int>(first.x()); x <= static_cast<int>(last.x()); ++x)
    for (int y = static_cast<int>(first.y()); y <= static_cast<int>(last.y()); ++y) visit(std::pair(x, y));
}

void SvgPage::take(const Box& box) {
  squares(box, [&](const std::pair<int, int>& square) { taken_[square].push_back(box); });
}

double SvgPage::crowding(const std::vector<std::string>& lines, const Spot& spot, const void* owner) const {
  const Box box = box_of(lines, spot);
  const auto overlap = [&](const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    const Eigen::Vector2d shared = box.high.cwiseMin(high) - box.low.cwiseMax(low);
    return shared.x() > 0.0 && shared.y() > 0.0 ? shared.x() * shared.y() : 0.0;
  };
  double sum = (box.high - box.low).prod() - overlap({0.0, 0.0}, {width_, height_});
  squares(box, [&](const std::pair<int, int>& square) {
    const auto here = taken_.find(square);
    if (here == taken_.end()) return;
    for (const Box& other : here->second) {
      // Boxes in several squares count in the one that has the corner of what they share.
      const Eigen::Vector2d corner = box.low.cwiseMax(other.low) / kSquare;
      if (square != std::pair(static_cast<int>(std::floor(corner.x())), static_cast<int>(std::floor(corner.y()))))
        continue;
      if (!owner || other.owner != owner) sum += overlap(other.low, other.high);
    }
  });
  return sum;
}

SvgPage::Spot SvgPage::label(const std::vector<std::string>& lines, const char* style, const std::vector<Spot>& spots,
                             const void* owner) {
  const Spot* best = spots.data();
  double least = std::numeric_limits<double>::infinity();
  for (const Spot& spot : spots) {
    const double crowded = crowding(lines, spot, owner);
    if (crowded >= least) continue;
    least = crowded;
    best = &spot;
    if (least <= 0.0) break;
  }
  text(lines, style, *best);
  take(box_of(lines, *best));
  return *best;
}

}  // namespace kinemap
