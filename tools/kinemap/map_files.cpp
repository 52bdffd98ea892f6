// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/map_files.hpp"

#include <cmath>
#include <filesystem>

#include "protocol/export/exports.hpp"
#include "protocol/map_json.hpp"
#include "protocol/tum.hpp"
#include "tools/kinemap/files.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;

Result<std::vector<TimedPose>> read_tum(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return Error{text.error()};
  auto poses = tum_from_text(*text);
  if (!poses) return Error{path + ": " + poses.error()};
  return poses;
}

/// Both files hold the same key poses, line by line.
std::optional<Error> read_trajectory(const fs::path& directory, MapSnapshot& map) {
  const auto optimised = read_tum((directory / "trajectory.tum").string());
  if (!optimised) return Error{optimised.error()};
  const auto odometry = read_tum((directory / "odometry.tum").string());
  if (!odometry) return Error{odometry.error()};
  const std::string where = (directory / "odometry.tum").string();
  if (optimised->size() != odometry->size())
    return Error{where + ": " + std::to_string(odometry->size()) + " poses, but trajectory.tum has " +
                 std::to_string(optimised->size()) + "; both must come from one build"};
  for (std::size_t i = 0; i < optimised->size(); ++i) {
    const TimedPose &a = (*optimised)[i], &b = (*odometry)[i];
    if (std::abs(a.time_s - b.time_s) > 1e-5)
      return Error{where + ": pose " + std::to_string(i + 1) + " is at another time than in trajectory.tum"};
    map.trajectory.push_back({static_cast<KeyPoseId>(i), a.time_s, a.pose, b.pose});
  }
  return std::nullopt;
}

}  // namespace

std::optional<Error> write_map_files(const std::string& directory, const MapSnapshot& map) {
  for (const Export& file : exports()) {
    const auto bytes = export_map(file, map);
    if (!bytes) return Error{bytes.error()};
    if (auto error = write_file((fs::path(directory) / file.name).string(), *bytes)) return error;
  }
  return std::nullopt;
}

Result<MapSnapshot> read_map_files(const std::string& path) {
  std::error_code code;
  const bool is_directory = fs::is_directory(path, code);
  const fs::path file = is_directory ? fs::path(path) / "map.json" : fs::path(path);
  const auto text = read_file(file.string());
  if (!text) return Error{text.error()};
  auto map = map_from_text(*text);
  if (!map) return Error{file.string() + ": " + map.error()};
  if (is_directory || fs::exists(file.parent_path() / "trajectory.tum", code))
    if (auto error = read_trajectory(file.parent_path(), *map)) return *error;
  return map;
}

}  // namespace kinemap::cli
