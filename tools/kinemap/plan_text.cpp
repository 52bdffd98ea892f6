// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/plan_text.hpp"

#include <algorithm>
#include <cmath>

#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

/// ANSI colours; a later, stronger layer wins the cell.
enum class Ink : std::uint8_t { None, Path, Wall, Chair, Table, Screen };
constexpr const char* kAnsi[] = {"", "\033[2m", "\033[1m", "\033[32m", "\033[33m", "\033[36m"};

Ink ink_of(ObjectType type) {
  constexpr Ink kInks[] = {Ink::Wall, Ink::Table, Ink::Screen, Ink::Chair};
  return kInks[static_cast<std::size_t>(type)];
}

/// Cells of 2 × 4 Braille dots, or a letter. Dots are about square on usual terminals.
class Canvas {
 public:
  Canvas(int columns, int rows) : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows)) {}

  void dot(int x, int y, Ink ink) {
    Cell* cell = at(x >> 1, y >> 2);
    if (!cell) return;
    constexpr std::uint8_t kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    cell->dots |= kBits[y & 3][x & 1];
    cell->ink = std::max(cell->ink, ink);
  }

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Ink ink) {
    const int steps = std::max(1, static_cast<int>(std::ceil((b - a).cwiseAbs().maxCoeff())));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector2d p = a + (b - a) * (static_cast<double>(i) / steps);
      dot(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())), ink);
    }
  }

  /// Letters over the middle dot, unless letters are there already.
  void label(const Eigen::Vector2d& p, const std::string& text, Ink ink) {
    const int row = static_cast<int>(p.y()) >> 2;
    const int length = static_cast<int>(text.size());
    const int first = std::clamp((static_cast<int>(p.x()) >> 1) - length / 2, 0, std::max(0, columns_ - length));
    for (int i = 0; i < length; ++i)
      if (const Cell* cell = at(first + i, row); !cell || cell->letter) return;
    for (int i = 0; i < length; ++i) {
      at(first + i, row)->letter = text[static_cast<std::size_t>(i)];
      at(first + i, row)->ink = ink;
    }
  }

  [[nodiscard]] std::string text(bool colour) const {
    std::string text;
    for (int y = 0; y < rows_; ++y) {
      std::string line;
      Ink last = Ink::None;
      for (int x = 0; x < columns_; ++x) {
        const Cell& cell = cells_[static_cast<std::size_t>(y * columns_ + x)];
        if (colour && cell.ink != last) line += std::string("\033[0m") + kAnsi[static_cast<std::size_t>(cell.ink)];
        last = cell.ink;
        append(cell, line);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text += line + (colour && last != Ink::None ? "\033[0m\n" : "\n");
    }
    return text;
  }

 private:
  struct Cell {
    std::uint8_t dots = 0;
    char letter = 0;
    Ink ink = Ink::None;
  };

  Cell* at(int column, int row) {
    const bool inside = column >= 0 && column < columns_ && row >= 0 && row < rows_;
    return inside ? &cells_[static_cast<std::size_t>(row * columns_ + column)] : nullptr;
  }

  /// U+2800 + dots in UTF-8; an empty cell is a plain space.
  static void append(const Cell& cell, std::string& line) {
    if (cell.letter || !cell.dots) {
      line += cell.letter ? cell.letter : ' ';
      return;
    }
    line += '\xE2';
    line += static_cast<char>(0xA0 | cell.dots >> 6);
    line += static_cast<char>(0x80 | (cell.dots & 0x3F));
  }

  int columns_, rows_;
  std::vector<Cell> cells_;
};

/// Metres to dots: y runs down, half a cell of margin all round.
struct Scale {
  Eigen::Vector2d low, high;
  double dots_per_m;
  Eigen::Vector2d operator()(const Eigen::Vector2d& p) const {
    return {2.0 + (p.x() - low.x()) * dots_per_m, 2.0 + (high.y() - p.y()) * dots_per_m};
  }
};

void draw_item(const Plan::Item& item, const Scale& scale, Canvas& canvas) {
  if (item.type == ObjectType::Wall) return;  // its stretches are drawn, with the doorways open
  const Ink ink = ink_of(item.type);
  for (std::size_t i = 1; i < item.outline.size(); ++i)
    canvas.line(scale(item.outline[i - 1]), scale(item.outline[i]), ink);
  if (item.outline.size() > 2) canvas.line(scale(item.outline.back()), scale(item.outline.front()), ink);
}

/// A length of 1, 2, 5 or 10 m that takes 6 to 30 columns.
std::string scale_bar(double dots_per_m) {
  double metres = 1.0;
  for (const double longer : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
    if (metres * dots_per_m / 2.0 < 6.0) metres = longer;
  const int width = std::max(2, static_cast<int>(std::lround(metres * dots_per_m / 2.0)));
  std::string bar = "├";
  for (int i = 2; i < width; ++i) bar += "─";
  return bar + format("┤ %.0f m", metres);
}

}  // namespace

std::string plan_text(const Plan& plan, int columns, int rows, bool colour) {
  const Eigen::Vector2d extent = plan.high - plan.low;
  if (extent.x() <= 0.0) return "nothing to draw yet\n";
  const double dots_per_m =
      std::min((2.0 * columns - 4.0) / extent.x(), (4.0 * rows - 4.0) / std::max(extent.y(), 1e-3));
  const Scale scale{plan.low, plan.high, dots_per_m};
  const Eigen::Vector2d dots = extent * dots_per_m;
  Canvas canvas((static_cast<int>(dots.x()) + 2) / 2 + 1, (static_cast<int>(dots.y()) + 2) / 4 + 1);

  // Every other step of the path: a trail, not a wall.
  for (std::size_t i = 1; i < plan.path.size(); i += 2) {
    const Eigen::Vector2d p = scale(plan.path[i]);
    canvas.dot(static_cast<int>(p.x()), static_cast<int>(p.y()), Ink::Path);
  }
  for (const WallStretch& wall : plan.walls)
    if (!wall.open && wall.wall_id) canvas.line(scale(wall.a), scale(wall.b), Ink::Wall);
  for (const Plan::Item& item : plan.items) draw_item(item, scale, canvas);
  for (const Plan::Item& item : plan.items) canvas.label(scale(item.centre), item.name(), ink_of(item.type));
  const std::string key = std::string("W wall  T table  S screen  C chair") + (plan.path.empty() ? "" : "  ⠂⠐ path");
  const std::string bar = scale_bar(dots_per_m);
  const bool beside = display_width(bar) + 3 + display_width(key) <= static_cast<std::size_t>(columns);
  return canvas.text(colour) + bar + (beside ? "   " : "\n") + key + '\n';
}

}  // namespace kinemap::cli
