// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/body.hpp"
#include "protocol/assembler.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// Called now and then with the part of the file that has been read (0–1).
using Progress = std::function<void(double)>;

/// What a recording contained, after it was read to the end.
struct RecordingSummary {
  std::string format;  ///< "pcap" or "mvnx"
  WearerInfo wearer;
  double rate_hz = 0.0;
  double duration_s = 0.0;
  AssemblerStats stream;              ///< for .mvnx only `frames` and the like are used
  std::vector<std::string> warnings;  ///< for people: a truncated last packet, a refused stream, …
};

/// What a recording yields, in order. `on_wearer` is called whenever more becomes known of the wearer.
struct RecordingSink {
  std::function<void(const SuitFrame&)> on_frame;
  std::function<void(const WearerInfo&)> on_wearer;
};

/// Reads a .pcap or .mvnx to its end (told apart by content, not by name), through the same Assembler as a live stream.
/// A directory is all its .pcap files in the order of their names, as kinemapd's recordings are. Memory does not grow
/// with the file. An Error names the path and the byte or line; a recording without a mappable wearer is an Error too.
Result<RecordingSummary> read_recording(const std::string& path, const AssemblerConfig& config,
                                        const RecordingSink& sink, const Progress& progress = {});
/// Several captures (or directories of them) as one, one after the other. What cannot be read of them is left out, with
/// a warning, as long as one can be read.
Result<RecordingSummary> read_recordings(const std::vector<std::string>& paths, const AssemblerConfig& config,
                                         const RecordingSink& sink, const Progress& progress = {});

}  // namespace kinemap
