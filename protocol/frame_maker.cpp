// SPDX-License-Identifier: Apache-2.0
#include "protocol/frame_maker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinemap {

namespace {

constexpr double kLeastField = 1e-3;  // of the undisturbed one

/// nullopt where there is no field at all: a sensor without a magnetometer.
std::optional<MagneticField> field_of(const std::optional<mxtp::TrackerItem>& tracker) {
  if (!tracker) return std::nullopt;
  const auto& [qw, qx, qy, qz] = tracker->orientation;
  const auto& [x, y, z] = tracker->magnetic_field;
  const Eigen::Vector3d field = Eigen::Quaterniond(qw, qx, qy, qz).normalized() * Eigen::Vector3d(x, y, z);
  const double norm = field.norm();
  if (norm < kLeastField) return std::nullopt;
  return MagneticField{norm, std::asin(std::clamp(-field.z() / norm, -1.0, 1.0))};
}

SuitFrame frame_of(const Sample& s) {
  SuitFrame out;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto& [x, y, z] = s.items[i].position;
    const auto& [qw, qx, qy, qz] = s.items[i].orientation;
    out.segments[i] = {{x, y, z}, Eigen::Quaterniond(qw, qx, qy, qz).normalized()};
  }
  if (s.extras.center_of_mass) {
    const auto& [x, y, z] = *s.extras.center_of_mass;
    out.center_of_mass = Eigen::Vector3d(x, y, z);
  }
  out.field_pelvis = field_of(s.extras.pelvis);
  out.field_right_forearm = field_of(s.extras.right_forearm);
  return out;
}

}  // namespace

const char* const kPinnedMessage =
    "the pelvis is fixed at the origin with the feet below it: an Upper Body or No Level scenario is streamed, which "
    "has no position in the "
    "room. In MVN choose a whole-body configuration and the scenario Single Level (Multi-Level for stairs), then "
    "calibrate again";

Shape shape_of(const Sample& s) {
  const std::size_t announced = s.header.body_segments + s.header.props + s.header.finger_segments;
  if (s.items.size() < kSegmentCount && (s.items.size() == 1 || announced == 0)) return Shape::NotAPerson;
  if (announced != 0 && s.header.body_segments != kSegmentCount) return Shape::NotAPerson;
  if (announced != 0 && s.items.size() != announced) return Shape::Malformed;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (s.items[i].id != static_cast<std::int32_t>(i + 1)) return Shape::Malformed;
  }
  return Shape::Person;
}

void FrameMaker::restart(bool other_wearer) {
  timeline_.restart();
  discontinuity_ = true;
  ++stats_->restarts;
  if (!other_wearer) return;
  guard_.reset();
  pinned_ = false;
}

void FrameMaker::take(const Sample& sample, const Assembler::FrameSink& sink) {
  const Shape shape = shape_of(sample);
  if (shape != Shape::Person) {
    (shape == Shape::NotAPerson ? stats_->not_a_person : stats_->malformed) += sample.datagrams;
    return;
  }
  if (sample.restarted) restart(false);
  const Timeline::Stamp stamp = timeline_.stamp(sample.clock);
  if (stamp.clock_jumped) ++stats_->clock_jumps;
  SuitFrame frame = frame_of(sample);
  frame.time_s = stamp.time_s;
  frame.index = static_cast<std::uint64_t>(sample.clock.index);
  frame.counter = static_cast<std::uint32_t>(sample.clock.index);
  frame.time_code_ms = sample.clock.time_code_ms;
  take(std::move(frame), sample.datagrams, sink);
}

void FrameMaker::take(SuitFrame frame, std::uint64_t datagrams, const Assembler::FrameSink& sink) {
  const FrameGuard::Result result = guard_.check(frame);
  if (result.odd_bones) ++stats_->odd_bones;
  if (result.verdict == FrameGuard::Verdict::WrongBones) {
    stats_->refused_bones += datagrams;
    return;
  }
  pinned_ = result.verdict == FrameGuard::Verdict::Pinned;
  if (pinned_) {
    stats_->refused_pinned += datagrams;
    discontinuity_ = true;
    return;
  }
  if (result.new_body) discontinuity_ = true;
  if (result.jumped && !discontinuity_) {
    ++stats_->jumps;
    discontinuity_ = true;
  }
  if (!first_time_s_) {
    first_time_s_ = frame.time_s;
    discontinuity_ = false;  // there is no frame before
  }
  frame.time_s -= *first_time_s_;
  // Indices go on growing when another stream takes over with a lower counter.
  if (last_index_ && frame.index + index_offset_ <= *last_index_) index_offset_ = *last_index_ + 1 - frame.index;
  frame.index += index_offset_;
  last_index_ = frame.index;
  frame.discontinuity = std::exchange(discontinuity_, false);
  stats_->used += datagrams;
  ++stats_->frames;
  sink(frame);
}

}  // namespace kinemap
