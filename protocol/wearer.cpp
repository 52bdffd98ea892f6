// SPDX-License-Identifier: Apache-2.0
#include "protocol/wearer.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

namespace kinemap {

namespace {

constexpr std::size_t kMostScaleBytes = 256 * 1024;
/// Height of the joint between neck and head over the floor, as a part of the body height, where the top of the head is
/// not given. Judged: 1.63 m for the 1.80 m of MVN's default body.
constexpr double kHeadJointPerStature = 0.905;

using Point = std::optional<Eigen::Vector3d>;

Eigen::Vector3d vector_of(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// The point of this name, with or without MVN's leading "p".
Point find_point(const mxtp::Scale& scale, std::string_view name) {
  for (const auto& p : scale.points) {
    std::string_view label = p.name;
    if (label.starts_with('p')) label.remove_prefix(1);
    if (label == name) return vector_of(p.position);
  }
  return std::nullopt;
}

Point find_first(const mxtp::Scale& scale, std::span<const std::string_view> names) {
  for (const auto name : names) {
    if (const auto p = find_point(scale, name)) return p;
  }
  return std::nullopt;
}

/// In the T-pose the right hand points along −y: anything else is no point of a hand.
bool is_hand_point(const Eigen::Vector3d& p, double nearest, double farthest) {
  return -p.y() >= nearest && -p.y() <= farthest && std::abs(p.x()) < 0.10 && std::abs(p.z()) < 0.10;
}

Point fingertip_of(const mxtp::Scale& scale) {
  constexpr std::array<std::string_view, 4> kNames{"RightTopOfHand", "RightMiddleFingerTip", "RightThirdFingerTip",
                                                   "RightIndexFingerTip"};
  const Point p = find_first(scale, kNames);
  return p && is_hand_point(*p, 0.10, 0.30) ? p : std::nullopt;
}

Point palm_of(const mxtp::Scale& scale, const Point& fingertip) {
  const Point pinky = find_point(scale, "RightPinky");
  const Point ball = find_point(scale, "RightBallHand");
  if (pinky && ball) {
    const Eigen::Vector3d middle = 0.5 * (*pinky + *ball);
    if (is_hand_point(middle, 0.03, 0.15)) return middle;
  }
  if (fingertip) return 0.5 * *fingertip;
  return std::nullopt;
}

std::optional<double> stature_of(const mxtp::Scale& scale) {
  const auto head =
      std::find_if(scale.segments.begin(), scale.segments.end(), [](const auto& s) { return s.name == "Head"; });
  if (head == scale.segments.end()) return std::nullopt;
  const double joint_m = head->origin[2];
  const Point top = find_point(scale, "TopOfHead");
  const double stature_m =
      top && top->z() > 0.05 && top->z() < 0.35 ? joint_m + top->z() : joint_m / kHeadJointPerStature;
  if (stature_m < 1.0 || stature_m > 2.5) return std::nullopt;
  return stature_m;
}

}  // namespace

void describe_body(const mxtp::Scale& scale, WearerInfo& info) {
  info.p_hand_fingertip = fingertip_of(scale);
  info.p_hand_palm = palm_of(scale, info.p_hand_fingertip);
  info.stature_m = stature_of(scale);
}

void WearerCollector::add(const mxtp::MetaData& meta) {
  for (const auto& [tag, value] : meta.tags) {
    if (tag == "name") info_.name = value;
  }
}

std::optional<mxtp::Fault> WearerCollector::add(const mxtp::Header& header, const mxtp::ScaleFragment& fragment) {
  parts_[header.datagram_index] = fragment.bytes;
  if (header.last_datagram) last_ = header.datagram_index;
  if (last_) parts_.erase(parts_.upper_bound(*last_), parts_.end());
  const std::size_t total = std::accumulate(parts_.begin(), parts_.end(), std::size_t{0},
                                            [](std::size_t n, const auto& part) { return n + part.second.size(); });
  if (total > kMostScaleBytes) {
    parts_.clear();
    last_.reset();
    return mxtp::Fault::BadLength;
  }
  std::vector<std::byte> joined;
  std::size_t next = 0;
  for (const auto& [index, bytes] : parts_) {
    if (index != next) break;
    joined.insert(joined.end(), bytes.begin(), bytes.end());
    ++next;
  }
  if (next == 0) return std::nullopt;
  // The parts so far may already be whole blocks: the body's lengths come first, its points later.
  const auto scale = mxtp::decode_scale(joined);
  if (const auto* whole = std::get_if<mxtp::Scale>(&scale)) {
    describe_body(*whole, info_);
    return std::nullopt;
  }
  return last_ && next == *last_ + 1U ? std::optional(std::get<mxtp::Fault>(scale)) : std::nullopt;
}

bool operator==(const WearerInfo& a, const WearerInfo& b) {
  return a.name == b.name && a.p_hand_fingertip == b.p_hand_fingertip && a.p_hand_palm == b.p_hand_palm &&
         a.stature_m == b.stature_m;
}

}  // namespace kinemap
