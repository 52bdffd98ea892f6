// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "protocol/wire/mxtp.hpp"
#include "tools/sim/session.hpp"
#include "tools/sim/trackers.hpp"

namespace kinemap::sim {

/// The datagrams of one sample, in sending order.
struct Packets {
  double time_s = 0.0;  ///< when to send them, since the first
  std::vector<mxtp::Bytes> datagrams;
};

/// Turns reported samples into what MVN sends: type 02 for every sample, types 12, 13, 23 and 24 as asked for; losses
/// in bursts. Quaternion signs flip at random, as MVN's do.
class Transmitter {
 public:
  explicit Transmitter(const Session& session);

  Packets send(const Sample& sample);
  [[nodiscard]] std::size_t lost() const { return lost_; }  ///< samples

 private:
  [[nodiscard]] mxtp::Header header(int type, const Sample& sample) const;
  bool lose(std::size_t index);
  std::vector<mxtp::SegmentItem> items(const Pose23& pose);

  const Session& session_;
  Random random_;
  double loss_, burst_;
  bool losing_ = false;
  std::size_t lost_ = 0;
  std::uint32_t first_counter_, first_time_ms_;
  std::array<bool, kBones> flipped_{};
  double next_meta_s_ = 0.0;
  Trackers trackers_;
};

/// The wearer as the suit knows it: T-pose joint positions and the hand's points.
mxtp::Scale scale_of(const Body& body);
/// The reported body's centre of mass, m.
Vec3 center_of_mass(const Pose23& pose);

}  // namespace kinemap::sim
