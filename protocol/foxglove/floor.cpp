// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/floor.hpp"

#include <string_view>

#include "protocol/floor.hpp"
#include "protocol/foxglove/json.hpp"

namespace kinemap::foxglove {
namespace {

constexpr double kCell = 0.1, kReach = 0.3;                                          // m: half a walking body's width
constexpr std::string_view kWalked("\x4d\xaf\x7c\x90", 4), kUnknown("\0\0\0\0", 4);  // red, green, blue, alpha
constexpr int kUint8 = 1;                                                            // foxglove.NumericType

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace

Message floor(const MapSnapshot& map) {
  const CellGrid grid = walked_floor(map.trajectory, kCell, kReach, wall_stretches(map));
  std::string data;
  data.reserve(4 * grid.cells.size());
  for (const std::uint8_t walked : grid.cells) data += walked ? kWalked : kUnknown;
  Json fields = Json::array();
  for (const char* name : {"red", "green", "blue", "alpha"})
    fields.push_back({{"name", name}, {"offset", fields.size()}, {"type", kUint8}});
  const Eigen::Vector3d corner(grid.origin.x(), grid.origin.y(), floor_height(map));
  return {Channel::Floor, nanoseconds(map.time_s),
          text_of({{"timestamp", time_json(map.time_s)},
                   {"frame_id", kMapFrame},
                   {"pose", pose_json({corner, Eigen::Quaterniond::Identity()})},
                   {"column_count", grid.columns},
                   {"cell_size", {{"x", grid.cell_m}, {"y", grid.cell_m}}},
                   {"row_stride", 4 * grid.columns},
                   {"cell_stride", 4},
                   {"fields", std::move(fields)},
                   {"data", base64(data)}})};
}

}  // namespace kinemap::foxglove
