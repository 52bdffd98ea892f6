// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/body.hpp"
#include "core/map.hpp"
#include "core/tracker/tracker.hpp"
#include "daemon/config.hpp"
#include "protocol/recording.hpp"

namespace kinemap::cli {

/// Seconds of wall clock that each stage took.
struct StageTimes {
  double read_s = 0.0;  ///< file and assembler
  double track_s = 0.0;
  double map_s = 0.0;
  [[nodiscard]] double total_s() const { return read_s + track_s + map_s; }
};

struct BatchResult {
  RecordingSummary recording;
  TrackerStats tracker;
  std::shared_ptr<const MapSnapshot> map;
  StageTimes times;
};

/// Called with each frame and the map as it is by then.
using Observer = std::function<void(const SuitFrame& frame, const MapSnapshot& map)>;

/// A recording, or several that follow on each other, to a map: the very pipeline of the daemon (assembler, tracker,
/// mapper), in one thread and without a clock, so that the same recording and configuration give the same map, byte for
/// byte. The Error names the file and what is wrong with it.
Result<BatchResult> build_map(const std::vector<std::string>& recordings, const Config& config,
                              const Progress& progress = {}, const Observer& observer = {});
Result<BatchResult> build_map(const std::string& recording, const Config& config, const Progress& progress = {},
                              const Observer& observer = {});

}  // namespace kinemap::cli
