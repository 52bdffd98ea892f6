// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/sitting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tracker/seat_posture.hpp"

namespace kinemap {
namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<Sitting> SittingFold::step(const SuitFrame& frame, const std::array<Sole, 2>& soles) {
  const SeatPosture posture = seat_posture_of(frame, soles, config_.shank_min);
  legs_sit_ = kinemap::legs_sit(posture, legs_sit_, config_);
  hips_m_ = posture.hips_m;
  const bool was_still = still_;
  const double speed = velocity_.step(frame.time_s, frame[Segment::Pelvis].p).norm();
  still_ = legs_sit_ && below_with_hysteresis(still_, speed, config_.speed_on_mps, config_.speed_off_mps);

  std::optional<Sitting> ended = end_if_over(frame.time_s, frame[Segment::Pelvis].p);
  if (legs_sit_ && !open_) open(frame.time_s);
  if (open_ && still_) judge(frame, soles, was_still);
  if (legs_sit_) seen_s_ = frame.time_s;
  time_s_ = frame.time_s;
  return ended;
}

std::optional<Sitting> SittingFold::end_if_over(double time_s, const Eigen::Vector3d& p_pelvis) {
  if (!open_) return std::nullopt;
  const bool gone = time_s - seen_s_ > (legs_sit_ ? config_.gap_s : config_.dropout_s);
  // A wearer on castors sits on the same chair in another place.
  const bool elsewhere =
      still_ && !samples_.empty() &&
      (p_pelvis - samples_.front().T_odom_seat().p).head<2>().norm() > config_.moved_m + config_.seat_behind_hip_m;
  return gone || elsewhere ? close() : std::nullopt;
}

void SittingFold::open(double time_s) {
  open_ = true;
  begin_s_ = time_s;
  seen_s_ = time_s;
  still_s_ = 0.0;
  unsupported_s_ = 0.0;
  outside_ = false;
  spacing_s_ = config_.sample_s;
  told_s_ = -std::numeric_limits<double>::infinity();
  samples_.clear();
}

void SittingFold::judge(const SuitFrame& frame, const std::array<Sole, 2>& soles, bool was_still) {
  const double outside = outside_of_feet_m(frame, soles, center_of_mass_of(frame));
  const bool was_outside = outside_;
  outside_ = outside > (outside_ ? config_.outside_off_m : config_.outside_on_m);
  // A longer gap says nothing about the time in between.
  const double dt = was_still && !samples_.empty() ? std::min(frame.time_s - time_s_, 0.5) : 0.0;
  still_s_ += dt;
  if (was_outside && outside_) unsupported_s_ += dt;
}

void SittingFold::record(const SuitFrame& frame, const KeyPose& latest) {
  if (!open_ || !still_) return;
  if (!samples_.empty() && frame.time_s - samples_.back().time_s < spacing_s_) return;
  const Pose& pelvis = frame[Segment::Pelvis];
  const Pose T_odom_hips = level_pose(pelvis.p, heading_of(pelvis.q));
  const Pose T_hips_seat{{-config_.seat_behind_hip_m, 0, -config_.hip_to_seat_m}, Eigen::Quaterniond::Identity()};
  const Pose T_key_seat = latest.T_odom_pelvis.inverse() * T_odom_hips * T_hips_seat;
  keep({{frame.time_s, latest.id, T_key_seat, hips_m_ - config_.hip_to_seat_m}, latest.T_odom_pelvis});
}

void SittingFold::keep(const Sample& sample) {
  if (samples_.size() >= config_.max_samples) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples_.size(); i += 2) samples_[kept++] = samples_[i];
    samples_.resize(kept);
    spacing_s_ *= 2.0;
  }
  samples_.push_back(sample);
}

std::optional<UnfinishedSitting> SittingFold::take_unfinished() {
  const bool first = told_s_ < begin_s_;
  const bool more = !samples_.empty() && samples_.back().time_s > told_s_;
  if (!open_ || (!first && !more && still_ == told_still_)) return std::nullopt;
  UnfinishedSitting piece{begin_s_, seen_s_, still_s_, unsupported_s_, still_, outside_, velocity_.velocity(), {}};
  for (const Sample& sample : samples_)
    if (sample.time_s > told_s_) piece.samples.push_back(sample);
  told_s_ = samples_.empty() ? begin_s_ : samples_.back().time_s;
  told_still_ = still_;
  return piece;
}

void SittingFold::resume(const Interrupted& before) {
  if (!before.sitting) return;
  open(before.sitting->begin_s);
  legs_sit_ = before.sitting->still;  // of legs that sat while the body moved nothing is said
  seen_s_ = time_s_ = before.sitting->seen_s;
  still_s_ = before.sitting->still_s;
  unsupported_s_ = before.sitting->unsupported_s;
  still_ = before.sitting->still;
  outside_ = before.sitting->outside;
  velocity_.resume(before.sitting->velocity);
  for (const SeatSample& sample : before.sitting->samples)
    if (const KeyPose* key_pose = before.find(sample.key_pose)) keep({sample, key_pose->T_odom_pelvis});
  told_s_ = samples_.empty() ? begin_s_ : samples_.back().time_s;
}

std::optional<Sitting> SittingFold::close() {
  if (!open_) return std::nullopt;
  open_ = false;
  return is_seat() ? std::optional(summary()) : std::nullopt;
}

std::optional<Sitting> SittingFold::reset() {
  std::optional<Sitting> ended = close();
  velocity_.reset();
  legs_sit_ = false;
  still_ = false;
  return ended;
}

bool SittingFold::is_seat() const {
  if (samples_.empty() || still_s_ < config_.min_still_s) return false;
  // With the feet under the chair, or leaning forward, one sits over one's feet. Nobody squats like that for long.
  return still_s_ >= config_.surely_still_s ||
         (unsupported_s_ >= config_.min_unsupported_s && unsupported_s_ >= config_.min_unsupported_share * still_s_);
}

Sitting SittingFold::summary() const {
  // Odometry goes on drifting while the wearer sits. Relative to the key pose in the middle of the bout the drift
  // before and after cancels in the median.
  const Sample& middle = samples_[samples_.size() / 2];
  const Pose T_key_odom = middle.T_odom_key.inverse();
  const double heading = heading_of(middle.T_odom_seat().q);
  std::array<std::vector<double>, 3> p_key_seat;
  std::vector<double> heights;
  std::vector<double> turns;
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d p = T_key_odom * sample.T_odom_seat().p;
    for (int i = 0; i < 3; ++i) p_key_seat[static_cast<std::size_t>(i)].push_back(p[i]);
    heights.push_back(sample.height_m);
    turns.push_back(wrap_angle(heading_of(sample.T_odom_seat().q) - heading));
  }
  const Eigen::Vector3d p(median(p_key_seat[0]), median(p_key_seat[1]), median(p_key_seat[2]));
  double squares = 0.0;
  for (const Sample& sample : samples_) squares += (T_key_odom * sample.T_odom_seat().p - p).squaredNorm();

  Sitting sitting;
  sitting.begin_s = begin_s_;
  sitting.end_s = seen_s_;
  sitting.key_pose = middle.key_pose;
  sitting.T_key_seat = {p, T_key_odom.q * level_pose(Eigen::Vector3d::Zero(), heading + median(turns)).q};
  sitting.height_m = median(heights);
  sitting.spread_m = std::sqrt(squares / static_cast<double>(samples_.size()));
  return sitting;
}

}  // namespace kinemap
