// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/frame_encoder.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

namespace kinemap::cli {

std::vector<mxtp::Bytes> encode_frame(const SuitFrame& frame) {
  mxtp::Header header;
  header.sample_counter = static_cast<std::uint32_t>(frame.index);
  header.time_code_ms = static_cast<std::uint32_t>(std::llround(frame.time_s * 1000.0));
  std::vector<mxtp::SegmentItem> items;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose& pose = frame.segments[i];
    const Eigen::Vector3f p = pose.p.cast<float>();
    const Eigen::Quaternionf q = pose.q.cast<float>();
    items.push_back({static_cast<std::int32_t>(i + 1), {p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}});
  }
  return mxtp::encode_poses(header, items);
}

Result<bool> is_xml_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char first[4] = {};
  if (!file || (!file.read(first, sizeof first) && file.bad()))
    return Error{path + ": cannot be read: " + std::strerror(errno)};
  if (file.gcount() == 0 && file.eof()) return Error{path + ": is empty"};
  if (std::memcmp(first, "\xEF\xBB\xBF", 3) == 0) return first[3] == '<';
  const char* at = first;
  while (at != first + 3 && std::strchr(" \t\r\n", *at)) ++at;
  return *at == '<';
}

}  // namespace kinemap::cli
