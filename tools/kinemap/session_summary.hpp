// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/journal.hpp"

namespace kinemap::cli {

/// What the entries of a journal tell at a glance, without a map being made of them.
struct SessionSummary {
  std::optional<std::int64_t> begin_unix_ms;  ///< wall clock
  std::string software;                       ///< version that began it
  std::vector<std::string> wearers;           ///< names, in the order of appearance
  double duration_s = 0.0;                    ///< stream time of the last entry
  double distance_m = 0.0;                    ///< way of the pelvis, as the suit gave it
  std::size_t key_poses = 0, breaks = 0;      ///< breaks: nothing is known of the way in between
  std::size_t traces = 0, contacts = 0, pivots = 0, sittings = 0;
  std::optional<journal::Announced> announced;  ///< the last word about the map; none in format 1
};

SessionSummary summary_of(const std::vector<journal::Entry>& entries);

/// "2026-11-22T10:33:03Z"; "?" when not known.
std::string utc_text(const std::optional<std::int64_t>& unix_ms);
/// 3725 → "1:02:05".
std::string duration_text(double seconds);
/// 1234567 → "1.2 MB".
std::string size_text(std::uint64_t bytes);

}  // namespace kinemap::cli
