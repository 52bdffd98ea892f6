// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/traces.hpp"

#include <algorithm>
#include <utility>

#include "core/stature.hpp"

namespace kinemap {

namespace {

constexpr double kRest = 0.08;  // m that a hand at rest sways, and what the suit errs by when it starts anew

}  // namespace

std::optional<Event> TraceFold::step(double time_s, const GestureState& gesture) {
  std::optional<Event> ended;
  if (open_ && gesture.none_since_s) seen_s_ = std::min(seen_s_, *gesture.none_since_s);
  const double unseen_s = time_s - seen_s_;
  if (open_ && unseen_s > (gesture.near ? config_.gap_s : config_.dropout_s)) ended = close();
  if (!gesture.near) return ended;
  if (!open_) {
    open_ = true;
    held_ = false;
    trace_.begin_s = time_s;
  }
  held_ = held_ || gesture.held;
  seen_s_ = time_s;
  return ended;
}

void TraceFold::record(const SuitFrame& frame, const KeyPose& latest) {
  const Pose& T_odom_hand = frame[Segment::RightHand];
  const Eigen::Vector3d p_hand_point(0, -config_.hand_point_m, 0);
  if (trace_.contacts.empty()) {
    trace_.stature_m = stature_from_bones(frame);
  } else {
    if (frame.time_s <= seen_s_) stretch(T_odom_hand.p);
    const double moved =
        std::max((T_odom_hand.p - kept_.p).norm(), (T_odom_hand * p_hand_point - kept_ * p_hand_point).norm());
    if (moved < config_.spacing_m && frame.time_s - kept_s_ < config_.spacing_s) return;
    if (trace_.contacts.size() >= config_.max_contacts) {
      ++thinned_out_;
      return;
    }
  }
  keep({frame.time_s, latest.id, latest.T_odom_pelvis.inverse() * T_odom_hand}, T_odom_hand);
}

void TraceFold::keep(const HandContact& contact, const Pose& T_odom_hand) {
  if (trace_.contacts.empty()) first_wrist_ = farthest_wrist_ = T_odom_hand.p;
  trace_.contacts.push_back(contact);
  hand_.push_back({contact.time_s, T_odom_hand});
  kept_ = T_odom_hand;
  kept_s_ = contact.time_s;
}

void TraceFold::stretch(const Eigen::Vector3d& wrist) {
  const double from_first = (wrist - first_wrist_).norm();
  if (from_first > (farthest_wrist_ - first_wrist_).norm()) farthest_wrist_ = wrist;
  extent_m_ = std::max({extent_m_, from_first, (wrist - farthest_wrist_).norm()});
}

bool TraceFold::waited(const Pose& T_odom_before, const SuitFrame& frame) const {
  return held() && !trace_.contacts.empty() && (T_odom_before * kept_.p - frame[Segment::RightHand].p).norm() < kRest;
}

void TraceFold::move(const Pose& T_odom_before, double unseen_s) {
  seen_s_ += unseen_s;
  for (HandSample& sample : hand_) sample.T_odom_hand = T_odom_before * sample.T_odom_hand;
  first_wrist_ = T_odom_before * first_wrist_;
  farthest_wrist_ = T_odom_before * farthest_wrist_;
  kept_ = T_odom_before * kept_;
}

std::optional<Event> TraceFold::close() {
  if (!open_) return std::nullopt;
  open_ = false;
  told_ = 0;
  Trace trace = std::exchange(trace_, {});
  std::vector<HandSample> hand = std::exchange(hand_, {});
  const double extent_m = std::exchange(extent_m_, 0.0);
  if (!held_) return std::nullopt;
  trace.end_s = seen_s_;
  // What the hand did after the gesture was last seen is not part of it.
  while (!trace.contacts.empty() && trace.contacts.back().time_s > seen_s_) trace.contacts.pop_back();
  hand.resize(trace.contacts.size());
  if (auto pivot = find_pivot(hand, pivot_)) {
    pivot->stature_m = trace.stature_m;
    return pivot;
  }
  if (trace.contacts.empty() || trace.end_s - trace.begin_s < config_.min_duration_s ||
      extent_m < config_.min_extent_m) {
    ++rejected_;
    return std::nullopt;
  }
  return trace;
}

std::optional<UnfinishedTrace> TraceFold::take_unfinished(const std::array<HipState, 2>& hips) {
  const auto same = [](const HipState& a, const HipState& b) { return a.near == b.near && a.held == b.held; };
  const bool changed = !same(hips[0], told_hips_[0]) || !same(hips[1], told_hips_[1]);
  if (!open_ || (told_ == trace_.contacts.size() && !changed)) return std::nullopt;
  told_hips_ = hips;
  const auto untold = trace_.contacts.begin() + static_cast<std::ptrdiff_t>(told_);
  told_ = trace_.contacts.size();
  return UnfinishedTrace{trace_.begin_s, seen_s_, held_, hips, trace_.stature_m, {untold, trace_.contacts.end()}};
}

void TraceFold::resume(const Interrupted& before) {
  if (!before.trace) return;
  open_ = true;
  held_ = before.trace->held;
  seen_s_ = before.trace->seen_s;
  trace_.begin_s = before.trace->begin_s;
  trace_.stature_m = before.trace->stature_m;
  for (const HandContact& contact : before.trace->contacts) {
    const KeyPose* key_pose = before.find(contact.key_pose);
    if (key_pose == nullptr) continue;
    const Pose T_odom_hand = key_pose->T_odom_pelvis * contact.T_key_hand;
    keep(contact, T_odom_hand);
    if (contact.time_s <= seen_s_) stretch(T_odom_hand.p);
  }
  told_ = trace_.contacts.size();
}

}  // namespace kinemap
