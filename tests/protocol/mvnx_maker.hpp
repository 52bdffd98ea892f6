// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <sstream>
#include <string>

#include "protocol/wire/segment_names.hpp"
#include "tests/protocol/body_stream.hpp"

namespace kinemap::testing_support {

/// How MVN's files of a version look: in version 3 the arms' segment frames are aligned with the world when the arms
/// hang.
struct MvnxStyle {
  int version = 4;
  bool t_pose_frame = true;
};

/// A segment's orientation as a file of that version has it: the T-pose one, but for the arms of version 3.
inline Eigen::Quaterniond file_orientation(const Eigen::Quaterniond& q, std::size_t segment, int version) {
  const bool right = segment >= 8 && segment <= 10;
  const bool left = segment >= 12 && segment <= 14;
  if (version != 3 || (!right && !left)) return q;
  // The vector from shoulder to hand is (0, ∓1, 0) in T-pose axes and (0, 0, −1) in N-pose axes: q_file * (0,0,−1) = q
  // * (0, ∓1, 0).
  const Eigen::Vector3d along_t(0, right ? -1 : 1, 0);
  const Eigen::Vector3d along_n(0, 0, -1);
  return q * Eigen::Quaterniond::FromTwoVectors(along_n, along_t);
}

inline void put_frame(std::ostream& out, const std::string& attributes, const std::vector<mxtp::SegmentItem>& items,
                      int version) {
  out << "<frame " << attributes << ">\n<orientation>";
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto& o = items[i].orientation;
    const Eigen::Quaterniond q = file_orientation(Eigen::Quaterniond(o[0], o[1], o[2], o[3]), i, version);
    out << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << (i + 1 < items.size() ? " " : "");
  }
  out << "</orientation>\n<position>";
  for (const auto& item : items) out << item.position[0] << ' ' << item.position[1] << ' ' << item.position[2] << ' ';
  out << "</position>\n<centerOfMass>0.5 0.25 1</centerOfMass></frame>\n";
}

inline std::string mvnx_head(const MvnxStyle& style) {
  std::ostringstream out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<mvnx version=\"" << style.version
      << "\">\n<comment>a note &amp; more</comment>\n"
      << "<subject label=\"Anna\" frameRate=\"120\" segmentCount=\"23\">\n<segments>\n";
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    out << "<segment label=\"" << kSegmentNames[i] << "\" id=\"" << i + 1 << "\"><points>\n";
    const char* tag = style.version == 3 ? "pos_s" : "pos_b";
    const auto point = [&](const char* label, const char* position) {
      out << "<point label=\"" << label << "\"><" << tag << '>' << position << "</" << tag << "></point>\n";
    };
    if (i == 6) point("pTopOfHead", "0 0 0.17");
    if (i == 10) point("pRightTopOfHand", style.version == 3 ? "0.01 0 -0.18" : "0.01 -0.18 0");
    out << "</points></segment>\n";
  }
  out << "</segments>\n<frames segmentCount=\"23\">\n";
  return out.str();
}

/// A file of `count` normal frames.
inline std::string mvnx(const MvnxStyle& style, std::uint64_t count) {
  std::ostringstream out;
  out.precision(9);
  out << mvnx_head(style);
  auto items = body_items(0);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto& p = t_pose()[i];
    items[i].position = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  }
  if (style.t_pose_frame) put_frame(out, R"(time="0" index="" type="tpose")", items, style.version);
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto ms = static_cast<std::uint64_t>(1000.0 * static_cast<double>(k) / 120.0);
    put_frame(out, "time=\"" + std::to_string(ms) + "\" index=\"" + std::to_string(k) + "\" type=\"normal\"",
              body_items(k), style.version);
  }
  out << "</frames>\n</subject>\n</mvnx>\n";
  return out.str();
}

}  // namespace kinemap::testing_support
