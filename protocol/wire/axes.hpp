// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "protocol/wire/mxtp.hpp"

namespace kinemap::mxtp {

/// Axes of type 01: centimetres, y up, rotations in degrees about x, then y, then z (fixed axes: R = Rz·Ry·Rx). With
/// both frames right-handed, (x, y, z) of type 01 is (y, z, x) of type 02. Found on a real pair of datagrams of one
/// sample (protocol/README.md).
struct EulerItem {
  std::array<float, 3> position_cm{};
  std::array<float, 3> angles_deg{};
};

EulerItem to_euler(const SegmentItem& item);
/// The quaternion has w ≥ 0; `id` is kept.
SegmentItem from_euler(std::int32_t id, const EulerItem& item);

}  // namespace kinemap::mxtp
