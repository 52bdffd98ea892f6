// SPDX-License-Identifier: Apache-2.0
#include "protocol/frame_guard.hpp"

#include <algorithm>
#include <cmath>

#include "core/reach.hpp"

namespace kinemap {

namespace {

struct Bone {
  Segment from;
  Segment to;
  double tolerance_m;
};

using enum Segment;
/// Distances between joints that a body keeps. The shank varies by 4 mm in real streams, foot to toe by 2 cm: the
/// latter is left out.
constexpr std::array<Bone, 20> kBoneTable{{
    {Pelvis, L5, 0.01},
    {L5, L3, 0.01},
    {L3, T12, 0.01},
    {T12, T8, 0.01},
    {T8, Neck, 0.01},
    {Neck, Head, 0.01},
    {T8, RightShoulder, 0.01},
    {RightShoulder, RightUpperArm, 0.01},
    {RightUpperArm, RightForearm, 0.01},
    {RightForearm, RightHand, 0.01},
    {T8, LeftShoulder, 0.01},
    {LeftShoulder, LeftUpperArm, 0.01},
    {LeftUpperArm, LeftForearm, 0.01},
    {LeftForearm, LeftHand, 0.01},
    {Pelvis, RightUpperLeg, 0.01},
    {RightUpperLeg, RightLowerLeg, 0.01},
    {RightLowerLeg, RightFoot, 0.02},
    {Pelvis, LeftUpperLeg, 0.01},
    {LeftUpperLeg, LeftLowerLeg, 0.01},
    {LeftLowerLeg, LeftFoot, 0.02},
}};
constexpr double kGrossM = 0.10;
constexpr double kAdoptAfterS = 0.5;
constexpr double kFollow = 0.02;  ///< share of the newest lengths in the mean

constexpr double kPinnedPelvisM = 0.05, kPinnedFeetM = -0.4;
constexpr double kFreePelvisM = 0.10, kFreeFeetM = -0.3;
constexpr double kPinnedJumpM = 0.3, kPinnedAfterS = 0.5;

bool is_possible(double thigh_m, double shank_m, double arm_m) {
  const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
  return within(thigh_m, 0.15, 0.8) && within(shank_m, 0.15, 0.8) && within(arm_m, 0.1, 0.6);
}

double lowest_foot(const SuitFrame& f) {
  return std::min({f[RightFoot].p.z(), f[LeftFoot].p.z(), f[RightToe].p.z(), f[LeftToe].p.z()});
}

}  // namespace

FrameGuard::Lengths FrameGuard::lengths_of(const SuitFrame& frame) {
  Lengths out{};
  for (std::size_t i = 0; i < kBones; ++i) out[i] = (frame[kBoneTable[i].to].p - frame[kBoneTable[i].from].p).norm();
  return out;
}

void FrameGuard::align_signs(SuitFrame& frame) {
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    Eigen::Quaterniond& q = frame.segments[i].q;
    if (last_q_ && q.dot((*last_q_)[i]) < 0.0) q.coeffs() = -q.coeffs();
  }
}

FrameGuard::Verdict FrameGuard::check_bones(const SuitFrame& frame, Result& out) {
  bool& odd = out.odd_bones;
  const Lengths now = lengths_of(frame);
  const bool possible = is_possible(now[15], now[16], now[8]);
  if (!lengths_) {
    odd = !possible;
    if (possible) lengths_ = now;
    return possible ? Verdict::Good : Verdict::WrongBones;
  }
  bool gross = !possible;
  for (std::size_t i = 0; i < kBones; ++i) {
    const double off = std::abs(now[i] - (*lengths_)[i]);
    odd = odd || off > kBoneTable[i].tolerance_m;
    gross = gross || off > kGrossM;
  }
  odd = odd || gross;
  if (!gross) {
    wrong_since_s_.reset();
    for (std::size_t i = 0; i < kBones; ++i) (*lengths_)[i] += kFollow * (now[i] - (*lengths_)[i]);
    return Verdict::Good;
  }
  // A body that stays other than it was has been measured anew in MVN; a single one is damage.
  if (!wrong_since_s_) wrong_since_s_ = frame.time_s;
  if (!possible || frame.time_s - *wrong_since_s_ < kAdoptAfterS) return Verdict::WrongBones;
  lengths_ = now;
  out.new_body = true;
  wrong_since_s_.reset();
  return Verdict::Good;
}

/// Someone may cross the origin of a building's lower floor, so a stream that was well is called pinned only once the
/// pelvis has jumped to the origin or has stayed there.
bool FrameGuard::is_pinned(const SuitFrame& frame) {
  const Eigen::Vector3d& p = frame[Pelvis].p;
  const double feet = lowest_foot(frame);
  if (pinned_) {
    pinned_ = p.norm() < kFreePelvisM && feet < kFreeFeetM;
    return pinned_;
  }
  if (p.norm() >= kPinnedPelvisM || feet >= kPinnedFeetM) {
    pinned_like_since_s_.reset();
    return false;
  }
  if (!pinned_like_since_s_) pinned_like_since_s_ = frame.time_s;
  const bool jumped = !last_pelvis_ || (p - last_pelvis_->p).norm() > kPinnedJumpM;
  pinned_ = jumped || frame.time_s - *pinned_like_since_s_ >= kPinnedAfterS;
  if (pinned_) pinned_like_since_s_.reset();
  return pinned_;
}

FrameGuard::Result FrameGuard::check(SuitFrame& frame) {
  Result out;
  out.verdict = check_bones(frame, out);
  if (out.verdict != Verdict::Good) return out;
  align_signs(frame);
  if (is_pinned(frame)) {
    out.verdict = Verdict::Pinned;
    return out;
  }
  out.jumped = last_pelvis_ && !within_reach(*last_pelvis_, frame[Pelvis], frame.time_s - last_s_);
  last_pelvis_ = frame[Pelvis];
  last_s_ = frame.time_s;
  auto& last = last_q_.emplace();
  for (std::size_t i = 0; i < kSegmentCount; ++i) last[i] = frame.segments[i].q;
  return out;
}

void FrameGuard::reset() { *this = FrameGuard{}; }

}  // namespace kinemap
