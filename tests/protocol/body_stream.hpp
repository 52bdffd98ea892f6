// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/body.hpp"
#include "protocol/wire/mxtp.hpp"

/// A made-up wearer for tests: a stiff body of 1.75 m in the T-pose that walks along a circle.
namespace kinemap::testing_support {

/// Segment origins in the T-pose, m, floor at z = 0.
inline const std::array<Eigen::Vector3d, kSegmentCount>& t_pose() {
  static const std::array<Eigen::Vector3d, kSegmentCount> kOrigins{{
      {0, 0, 0.93},        {0, 0, 1.03},     {0, 0, 1.14},     {0, 0, 1.24},     {0, 0, 1.34},       {0, 0, 1.48},
      {0, 0, 1.58},        {0, -0.03, 1.42}, {0, -0.17, 1.42}, {0, -0.46, 1.42}, {0, -0.71, 1.42},   {0, 0.03, 1.42},
      {0, 0.17, 1.42},     {0, 0.46, 1.42},  {0, 0.71, 1.42},  {0, -0.09, 0.93}, {0, -0.09, 0.51},   {0, -0.09, 0.09},
      {0.16, -0.09, 0.02}, {0, 0.09, 0.93},  {0, 0.09, 0.51},  {0, 0.09, 0.09},  {0.16, 0.09, 0.02},
  }};
  return kOrigins;
}

/// The body of sample `k`: 5 mm further and 0.5° turned at each step. `shift` moves it as a whole.
inline std::vector<mxtp::SegmentItem> body_items(std::uint64_t k,
                                                 const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  const double heading = 0.5 * 3.14159265358979 / 180.0 * static_cast<double>(k);
  const double radius = 0.57;
  const Eigen::Vector3d at(radius * std::sin(heading) + 1.0, radius * (1.0 - std::cos(heading)), 0.0);
  const Eigen::Quaterniond q(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()));
  std::vector<mxtp::SegmentItem> out;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Eigen::Vector3d p = at + shift + q * t_pose()[i];
    mxtp::SegmentItem item;
    item.id = static_cast<std::int32_t>(i + 1);
    item.position = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
    item.orientation = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                        static_cast<float>(q.z())};
    out.push_back(item);
  }
  return out;
}

/// Header of sample `k` at a rate; the counter starts at `first`, the time code at `first_ms`.
inline mxtp::Header header_of(std::uint64_t k, double rate_hz = 120.0, std::uint32_t first = 0,
                              std::uint32_t first_ms = 0) {
  mxtp::Header h;
  h.sample_counter = first + static_cast<std::uint32_t>(k);
  const auto ms = first_ms + static_cast<std::uint64_t>(std::llround(1e3 * static_cast<double>(k) / rate_hz));
  h.time_code_ms = static_cast<std::uint32_t>(ms % 86'400'000);
  return h;
}

inline mxtp::Bytes read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto* data = reinterpret_cast<const std::byte*>(text.data());
  return {data, data + text.size()};
}

inline bool exists(const std::string& path) { return std::ifstream(path).good(); }

}  // namespace kinemap::testing_support
