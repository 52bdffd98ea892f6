// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace kinemap {

/// How long something took each time, as a histogram. Plain numbers: the one thread that adds hands copies on through
/// a LatestValue, so that nobody who looks ever holds it up.
struct Durations {
  static constexpr std::array<double, 22> kBounds{1e-6, 2.5e-6, 5e-6,   1e-5, 2.5e-5, 5e-5,   1e-4, 2.5e-4,
                                                  5e-4, 1e-3,   2.5e-3, 5e-3, 1e-2,   2.5e-2, 5e-2, 0.1,
                                                  0.25, 0.5,    1.0,    2.5,  5.0,    10.0};  ///< s

  std::array<std::uint64_t, kBounds.size() + 1>
      counts{};  ///< [i]: above bound i − 1, up to bound i; the last: above all
  double sum_s = 0.0;

  void add(double seconds) {
    const auto bound = std::lower_bound(kBounds.begin(), kBounds.end(), seconds);
    ++counts[static_cast<std::size_t>(bound - kBounds.begin())];
    sum_s += seconds;
  }
};

}  // namespace kinemap
