// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/qr_text.hpp"

#include <qrencode.h>

#include <memory>

namespace kinemap::cli {

std::string qr_text(const std::string& text, bool colour) {
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_L, QR_MODE_8, /*casesensitive=*/1), QRcode_free);
  if (!code) return {};
  constexpr int kQuiet = 4;  // modules around the code, which readers need
  const auto dark = [&](int row, int column) {
    const bool inside = row >= 0 && column >= 0 && row < code->width && column < code->width;
    return inside && (code->data[row * code->width + column] & 1) != 0;
  };
  std::string picture;
  for (int row = -kQuiet; row < code->width + kQuiet; row += 2) {
    if (colour) picture += "\033[30;107m";
    for (int column = -kQuiet; column < code->width + kQuiet; ++column) {
      const bool upper = dark(row, column), lower = dark(row + 1, column);
      picture += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
    }
    picture += colour ? "\033[0m\n" : "\n";
  }
  return picture;
}

}  // namespace kinemap::cli
