// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "protocol/wire/mxtp.hpp"
#include "tools/sim/magnetic_field.hpp"
#include "tools/sim/session.hpp"

namespace kinemap::sim {

/// The suit's 17 motion trackers: what they measure, and where the suit believes they point. Call in frame order.
class Trackers {
 public:
  explicit Trackers(const Session& session);
  std::vector<mxtp::TrackerItem> measure(const Sample& sample);

 private:
  static constexpr std::size_t kCount = 17;
  const Session& session_;
  Random random_;
  MagneticWorld world_;
  std::array<Quat, kCount> mount_;  ///< of the tracker on its segment
  std::array<Quat, kCount> last_;   ///< true orientation at the sample before
  bool any_ = false;
};

}  // namespace kinemap::sim
