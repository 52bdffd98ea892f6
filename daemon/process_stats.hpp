// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kinemap {

/// What this process takes of the machine, by /proc/self and getrusage(2); 0 where that cannot be read.
struct ProcessStats {
  double cpu_s = 0.0;  ///< of all threads, user and system
  std::uint64_t virtual_bytes = 0;
  std::uint64_t resident_bytes = 0;
  std::uint64_t open_files = 0;
  std::uint64_t max_open_files = 0;
  std::uint64_t threads = 0;
};

ProcessStats process_stats();

}  // namespace kinemap
