// SPDX-License-Identifier: Apache-2.0
#include "daemon/resume.hpp"

#include <utility>

namespace kinemap {
namespace {

constexpr double kLongestS = 12 * 3600.0;
constexpr double kClockS = 30.0;  // wall clock against counter: buffers, a paused sender, a clock that is being set
constexpr double kClockShare = 0.01;
constexpr double kSpeed = 3.0;  // m/s that a person in a suit walks or runs at most, over minutes
constexpr double kStep = 1.0;   // m

}  // namespace

std::optional<ResumePoint> resume_point(const std::vector<journal::Entry>& entries) {
  const KeyPose* key_pose = nullptr;
  const journal::StreamMark* before = nullptr;
  const journal::StreamMark* mark = nullptr;
  for (const auto& entry : entries) {
    if (const auto* k = std::get_if<KeyPose>(&entry)) key_pose = k;
    if (const auto* m = std::get_if<journal::StreamMark>(&entry)) before = std::exchange(mark, m);
  }
  if (key_pose == nullptr || before == nullptr) return std::nullopt;
  const double steps = static_cast<double>(mark->index) - static_cast<double>(before->index);
  const double seconds = mark->time_s - before->time_s;
  if (steps <= 0.0 || seconds <= 0.0) return std::nullopt;
  return ResumePoint{*key_pose, *mark, steps / seconds};
}

std::optional<double> time_since(const ResumePoint& point, const SuitFrame& frame, std::int64_t unix_ms) {
  // The counter has 32 bits; one that begins anew is behind, and behind is nearly a whole turn ahead.
  const auto steps = static_cast<std::uint32_t>(frame.index - point.mark.index);
  const double since_s = steps / point.rate_hz;
  const double clock_s = static_cast<double>(unix_ms - point.mark.unix_ms) / 1000.0;
  if (since_s > kLongestS) return std::nullopt;
  if (clock_s > since_s + kClockS + kClockShare * since_s) return std::nullopt;
  const Eigen::Vector3d walked = frame[Segment::Pelvis].p - point.key_pose.T_odom_pelvis.p;
  if (walked.head<2>().norm() > kStep + kSpeed * since_s) return std::nullopt;
  return since_s;
}

}  // namespace kinemap
