// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/score.hpp"

namespace kinemap::sim {

namespace {

/// Index of the last key that begins at or before `time_s`, or −1.
template <class Keys>
long active(const Keys& keys, double time_s) {
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), time_s, [](double t, const auto& key) { return t < key.begin_s; });
  return after - keys.begin() - 1;
}

}  // namespace

void Track::to(double begin_s, double end_s, double value) {
  if (!keys_.empty()) begin_s = std::max(begin_s, keys_.back().end_s);
  keys_.push_back({begin_s, std::max(end_s, begin_s + 0.05), value});
}

double Track::at(double time_s) const {
  const long i = active(keys_, time_s);
  if (i < 0) return start_;
  const Key& key = keys_[static_cast<std::size_t>(i)];
  const double from = i == 0 ? start_ : keys_[static_cast<std::size_t>(i) - 1].value;
  return from + (key.value - from) * smooth_step((time_s - key.begin_s) / (key.end_s - key.begin_s));
}

void ArmTrack::to(double begin_s, double end_s, const ArmGoal& goal) {
  const double hurried = 0.8 * (end_s - begin_s);  // a late start is partly made up for
  if (!keys_.empty()) begin_s = std::max(begin_s, keys_.back().end_s);
  goals_.push_back(goal);
  keys_.push_back({begin_s, std::max({end_s, begin_s + hurried, begin_s + 0.2}), goals_.size() - 1});
}

ArmTrack::Blend ArmTrack::at(double time_s) const {
  const long i = active(keys_, time_s);
  if (i < 0) return {&goals_[0], &goals_[0], 1.0};
  const Key& key = keys_[static_cast<std::size_t>(i)];
  return {&goals_[key.goal - 1], &goals_[key.goal], smooth_step((time_s - key.begin_s) / (key.end_s - key.begin_s))};
}

}  // namespace kinemap::sim
