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
  KeyPose key_pose;          ///< the last one
  journal::StreamMark mark;  ///< the last one
  double rate_hz = 0.0;      ///< steps of the sample counter per second, from the last two marks
};

/// nullopt when the session is too short to be recognised again (less than two marks, about two seconds).
std::optional<ResumePoint> resume_point(const std::vector<journal::Entry>& entries);

/// How long after the mark (s, by the sample counter) this frame was taken, when it is of the same stream: the counter
/// went on (a suit that was restarted counts from 0) for at least as long as the wall clock says (which may be behind,
/// on a computer whose clock has no battery), and the wearer can have walked there. nullopt: another stream.
std::optional<double> time_since(const ResumePoint& point, const SuitFrame& frame, std::int64_t unix_ms);

}  // namespace kinemap
