// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/slip.hpp"

#include <algorithm>
#include <cmath>

#include "core/pose.hpp"

namespace kinemap {
namespace {

constexpr double kWindow = 0.15;      // s over which speeds are judged
constexpr double kLongestGap = 0.15;  // s without a frame; nothing is known of a foot after more
constexpr double kLow = 0.06;         // m: a foot whose ball is so far over the other's is in the air
constexpr double kLook = 1.0;         // s after which it is looked whether a standing foot has moved
constexpr int kLeastMoved = 3;        // looks

}  // namespace

std::optional<Slip> SlipFold::step(const SuitFrame& frame, const std::array<Sole, 2>& soles) {
  if (!window_.empty() && frame.time_s - window_.back().time_s > kLongestGap) reset();
  Sample sample{frame.time_s, frame[Segment::Pelvis].p.head<2>(), {}};
  const double lowest = std::min(soles[0].under_ball.z(), soles[1].under_ball.z());
  for (std::size_t i = 0; i < 2; ++i)
    sample.feet[i] = {frame[kFoot[i]].p, frame[kToe[i]].p, heading_of(frame[kFoot[i]].q),
                      soles[i].under_ball.z() < lowest + kLow};
  window_.push_back(std::move(sample));
  while (window_.size() > 2 && window_[1].time_s <= frame.time_s - kWindow) window_.pop_front();

  if (frame.time_s - window_.front().time_s >= kWindow) {
    const auto middle = std::lower_bound(window_.begin(), window_.end(), frame.time_s - 0.5 * kWindow,
                                         [](const Sample& s, double time_s) { return s.time_s < time_s; });
    if (heard_ && middle->time_s > heard_->time_s) hear(*heard_, *middle);
    heard_ = *middle;
  }
  if (moved_ < kLeastMoved || moved_ <= stayed_ || slip_.stood_s == 0.0) return std::nullopt;
  slip_.apart_rad = std::abs(apart_rad_);
  return slip_;
}

bool SlipFold::stands(std::size_t foot, const Sample& middle) const {
  const Sample &first = window_.front(), &last = window_.back();
  const Foot &a = first.feet[foot], &b = last.feet[foot];
  const double seconds = last.time_s - first.time_s;
  return middle.feet[foot].low && (b.ankle - a.ankle).norm() < config_.speed_mps * seconds &&
         (b.ball - a.ball).norm() < config_.speed_mps * seconds &&
         std::abs(wrap_angle(b.heading - a.heading)) < config_.turn_rad_per_s * seconds;
}

void SlipFold::hear(const Sample& before, const Sample& now) {
  std::array<std::optional<double>, 2> turned;  // by each foot that is heard
  for (std::size_t i = 0; i < 2; ++i) {
    Standing& standing = standing_[i];
    if (!stands(i, now)) {
      standing = {};
      continue;
    }
    if (!standing.since_s) standing.since_s = now.time_s;
    if (before.time_s - *standing.since_s < config_.settle_s) continue;
    turned[i] = -wrap_angle(now.feet[i].heading - before.feet[i].heading);
    look(i, now);
  }
  const int count = int{turned[0].has_value()} + int{turned[1].has_value()};
  const Eigen::Vector2d streamed = now.p_pelvis - before.p_pelvis;
  const Eigen::Rotation2Dd turned_before(slip_.turn_rad);
  if (count == 0) {
    slip_.way_m += turned_before * streamed - streamed;
    return;
  }
  slip_.turn_rad += (turned[0].value_or(0.0) + turned[1].value_or(0.0)) / count;
  const Eigen::Rotation2Dd turned_now(slip_.turn_rad);
  Eigen::Vector2d way = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    if (!turned[i]) continue;
    const Eigen::Vector2d from_foot_before = before.p_pelvis - before.feet[i].ball.head<2>();
    const Eigen::Vector2d from_foot = now.p_pelvis - now.feet[i].ball.head<2>();
    way += (turned_now * from_foot - turned_before * from_foot_before) / count;
  }
  slip_.way_m += way - streamed;
  slip_.stood_s += now.time_s - before.time_s;
  if (count == 2) apart_rad_ += *turned[0] - *turned[1];
}

void SlipFold::look(std::size_t foot, const Sample& now) {
  Standing& standing = standing_[foot];
  const Eigen::Vector3d& ball = now.feet[foot].ball;
  if (standing.looked_s && now.time_s - *standing.looked_s < kLook) return;
  if (standing.looked_s) ++((ball - standing.ball).head<2>().norm() > config_.held_m ? moved_ : stayed_);
  standing.looked_s = now.time_s;
  standing.ball = ball;
}

void SlipFold::begin() {
  slip_ = {};
  apart_rad_ = 0.0;
}

void SlipFold::reset() {
  window_.clear();
  heard_.reset();
  standing_ = {};
}

}  // namespace kinemap
