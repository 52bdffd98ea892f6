// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/support.hpp"

#include <array>

namespace kinemap::test {
namespace {

/// Joint positions of a person of 1.75 m in T-pose (x forward, y left, z up; m), in stream order.
constexpr std::array<std::array<float, 3>, 23> kTPose{{
    {0, 0, 0.95F},      {0, 0, 1.05F},      {0, 0, 1.15F},         {0, 0, 1.25F},          {0, 0, 1.35F},
    {0, 0, 1.49F},      {0, 0, 1.59F},      {0, -0.04F, 1.44F},    {0, -0.18F, 1.44F},     {0, -0.47F, 1.44F},
    {0, -0.72F, 1.44F}, {0, 0.04F, 1.44F},  {0, 0.18F, 1.44F},     {0, 0.47F, 1.44F},      {0, 0.72F, 1.44F},
    {0, -0.09F, 0.94F}, {0, -0.09F, 0.51F}, {0, -0.09F, 0.09F},    {0.16F, -0.09F, 0.02F}, {0, 0.09F, 0.94F},
    {0, 0.09F, 0.51F},  {0, 0.09F, 0.09F},  {0.16F, 0.09F, 0.02F},
}};

}  // namespace

LiveBody body_at(double time_s, const Eigen::Vector3d& p) {
  SuitFrame frame;
  frame.time_s = time_s;
  for (Pose& segment : frame.segments) segment.p = p;
  return live_body_of(frame, 0.0);
}

mxtp::Bytes glider_datagram(std::uint32_t index, std::uint8_t character) {
  std::vector<mxtp::SegmentItem> items;
  for (std::size_t i = 0; i < kTPose.size(); ++i) {
    auto position = kTPose[i];
    position[0] += static_cast<float>(index) / 120.0F;
    items.push_back({static_cast<std::int32_t>(i + 1), position, {1, 0, 0, 0}});
  }
  mxtp::Header header;
  header.sample_counter = index;
  header.time_code_ms = static_cast<std::uint32_t>((index * 25 + 2) / 3);
  header.character = character;
  return mxtp::encode_poses(header, items).front();
}

mxtp::Bytes name_datagram(const std::string& name, std::uint8_t character) {
  mxtp::Header header;
  header.type = 12;
  header.character = character;
  return mxtp::encode_meta(header, {{{"name", name}}});
}

}  // namespace kinemap::test
