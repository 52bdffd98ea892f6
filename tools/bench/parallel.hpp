// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace kinemap::bench {

/// Calls work(0) … work(count − 1), up to `jobs` at a time (0: one for each core), in any order. `work` must not throw.
template <class Work>
void parallel_for(std::size_t count, int jobs, Work work) {
  std::atomic<std::size_t> next = 0;
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const auto threads = jobs > 0 ? static_cast<unsigned>(jobs) : std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> helpers;
  for (unsigned k = 1; k < threads && k < count; ++k) helpers.emplace_back(take);
  take();
}

}  // namespace kinemap::bench
