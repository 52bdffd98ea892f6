// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "protocol/journal.hpp"

namespace kinemap {

/// Where a stored session ended.
struct ResumePoint {
  Interrupted tracker;
  journal::StreamMark mark;  ///< the last one
  double rate_hz = 0.0;      ///< steps of the sample counter per second, from the last two marks

  /// Until when the wearer was seen, and where.
  [[nodiscard]] double seen_s() const;
  [[nodiscard]] const Pose& T_odom_pelvis() const;
};

/// nullopt when the session is too short to be recognised again (less than two marks, about two seconds).
std::optional<ResumePoint> resume_point(const std::vector<journal::Entry>& entries);

/// How long after the mark (s) this frame was taken, when it is of the same stream. It is when the counter went on (a
/// suit that was restarted counts from 0), the wearer can have walked there, and
/// - it went on for at least as long as the wall clock says (which may be behind, on a computer whose clock has no
///   battery), or
/// - it goes on right where the session ended, however long ago that was on the wall: the sender held, counter and all.
///   Whether time went on for the wearer meanwhile, the suit's time code tells.
/// nullopt: another stream.
std::optional<double> time_since(const ResumePoint& point, const SuitFrame& frame, std::int64_t unix_ms);

}  // namespace kinemap
