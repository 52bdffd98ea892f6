// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/recording.hpp"

namespace kinemap {

/// Reads an .mvnx file of version 3 or 4 to its end, as a stream (memory does not grow with the file): the first
/// subject, or the one that `config.character` counts to (0, 1, …). Only `normal` frames are motion. Segment frames of
/// version 3 (aligned with the world in the N-pose) are turned to the T-pose convention of core/body.hpp. An Error
/// names path:line. A file that ends within a frame gives a warning.
Result<RecordingSummary> read_mvnx(const std::string& path, const AssemblerConfig& config, const RecordingSink& sink,
                                   const Progress& progress = {});

}  // namespace kinemap
