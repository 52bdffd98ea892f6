// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/stream.hpp"

#include <string>

namespace kinemap::sim {

namespace {

std::array<float, 3> floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Joint positions in the T-pose, standing on z = 0.
std::array<Vec3, kBones> t_pose(const Body& body) {
  Pose23 pose;
  pose[kPelvis].p = Vec3(0, 0, body.hip_height());
  forward_kinematics(body, pose);
  std::array<Vec3, kBones> out;
  for (std::size_t i = 0; i < kBones; ++i) out[i] = pose[i].p;
  return out;
}

}  // namespace

mxtp::Scale scale_of(const Body& body) {
  mxtp::Scale scale;
  const auto joints = t_pose(body);
  for (std::size_t i = 0; i < kBones; ++i) scale.segments.push_back({bone_name(i), floats(joints[i])});
  const double tip = 0.105 * body.stature, palm = 0.052 * body.stature;
  const auto add = [&](std::size_t bone, std::uint16_t point, const char* name, const Vec3& p) {
    scale.points.push_back({static_cast<std::uint16_t>(bone + 1), point, name, 0, floats(p)});
  };
  add(kRightHand, 1, "pRightTopOfHand", {0, -tip, 0});
  add(kRightHand, 2, "pRightPalm", {0, -palm, -0.02});
  add(kLeftHand, 1, "pLeftTopOfHand", {0, tip, 0});
  add(kLeftHand, 2, "pLeftPalm", {0, palm, -0.02});
  return scale;
}

Vec3 center_of_mass(const Pose23& pose) {
  // Segment masses in per cent of the body (after Winter), each at the middle between two joints.
  struct Part {
    Bone from, to;
    double mass;
  };
  static constexpr std::array<Part, 11> kParts{{{kPelvis, kT12, 28.1},
                                                {kT8, kNeck, 21.6},
                                                {kNeck, kHead, 8.1},
                                                {kRightUpperArm, kRightForearm, 2.8},
                                                {kLeftUpperArm, kLeftForearm, 2.8},
                                                {kRightForearm, kRightHand, 2.2},
                                                {kLeftForearm, kLeftHand, 2.2},
                                                {kRightUpperLeg, kRightLowerLeg, 10.0},
                                                {kLeftUpperLeg, kLeftLowerLeg, 10.0},
                                                {kRightLowerLeg, kRightToe, 6.1},
                                                {kLeftLowerLeg, kLeftToe, 6.1}}};
  Vec3 sum = Vec3::Zero();
  for (const auto& part : kParts) sum += part.mass / 100.0 * 0.5 * (pose[part.from].p + pose[part.to].p);
  return sum;
}

Transmitter::Transmitter(const Session& session)
    : session_(session),
      random_(session.options().seed, 6),
      loss_(session.options().packet_loss ? *session.options().packet_loss : session.column().packet_loss),
      burst_(session.column().loss_burst),
      first_counter_(static_cast<std::uint32_t>(random_.integer(0, 100000))),
      first_time_ms_(static_cast<std::uint32_t>(random_.integer(8 * 3600, 18 * 3600)) * 1000U),
      trackers_(session) {}

mxtp::Header Transmitter::header(int type, const Sample& sample) const {
  mxtp::Header h;
  h.type = type;
  h.sample_counter = type == 12 || type == 13 ? 0 : first_counter_ + static_cast<std::uint32_t>(sample.index);
  h.time_code_ms = first_time_ms_ + static_cast<std::uint32_t>(std::floor(sample.time_s * 1000.0 + 1e-6));
  return h;
}

/// Two-state loss model: bursts of `burst_` samples on average, `loss_` of all samples in the mean. The first is never
/// lost.
bool Transmitter::lose(std::size_t index) {
  if (loss_ <= 0.0 || index == 0) return false;
  const double leave = 1.0 / std::max(1.0, burst_), enter = std::min(1.0, leave * loss_ / (1.0 - loss_));
  losing_ = losing_ ? !random_.chance(leave) : random_.chance(enter);
  return losing_;
}

std::vector<mxtp::SegmentItem> Transmitter::items(const Pose23& pose) {
  std::vector<mxtp::SegmentItem> out;
  for (std::size_t i = 0; i < kBones; ++i) {
    if (random_.chance(0.002)) flipped_[i] = !flipped_[i];
    const double sign = flipped_[i] ? -1.0 : 1.0;
    const Quat& q = pose[i].q;
    out.push_back({static_cast<std::int32_t>(i + 1),
                   floats(pose[i].p),
                   {static_cast<float>(sign * q.w()), static_cast<float>(sign * q.x()),
                    static_cast<float>(sign * q.y()), static_cast<float>(sign * q.z())}});
  }
  return out;
}

Packets Transmitter::send(const Sample& sample) {
  Packets packets;
  packets.time_s = sample.time_s;
  const auto segments = items(sample.reported);
  const auto trackers = session_.options().send_tracker ? trackers_.measure(sample) : std::vector<mxtp::TrackerItem>{};
  const bool meta = sample.time_s >= next_meta_s_;
  if (meta) next_meta_s_ += 1.0;
  if (lose(sample.index)) {
    ++lost_;
    return packets;
  }
  const SimOptions& options = session_.options();
  packets.datagrams = mxtp::encode_poses(header(2, sample), segments);
  if (options.send_tracker) {
    for (auto& part : mxtp::encode_trackers(header(23, sample), trackers)) packets.datagrams.push_back(std::move(part));
  }
  if (options.send_center_of_mass) {
    packets.datagrams.push_back(
        mxtp::encode_center_of_mass(header(24, sample), {floats(center_of_mass(sample.reported))}));
  }
  if (meta && options.send_meta) {
    const mxtp::MetaData tags{
        {{"name", "Simulated " + std::to_string(options.seed)}, {"xmid", "SIM"}, {"color", "5A8CFF"}}};
    packets.datagrams.push_back(mxtp::encode_meta(header(12, sample), tags));
  }
  if (meta && options.send_scale) {
    for (auto& part : mxtp::encode_scale(header(13, sample), scale_of(session_.reported_body())))
      packets.datagrams.push_back(std::move(part));
  }
  return packets;
}

}  // namespace kinemap::sim
