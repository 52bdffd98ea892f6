// SPDX-License-Identifier: Apache-2.0
// Writes the seeds that are best made by our own writers, so that they follow the formats: fuzz_seeds FOLDER makes
// FOLDER/NAME/….
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config.hpp"
#include "protocol/journal.hpp"
#include "protocol/journal_entries.hpp"
#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/pcap.hpp"
#include "tests/protocol/body_stream.hpp"
#include "tests/protocol/mvnx_maker.hpp"

namespace {

using namespace kinemap;
using namespace kinemap::testing_support;
namespace fs = std::filesystem;

void write(const fs::path& path, std::string_view bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A stream with every decoded type.
std::vector<std::pair<mxtp::Bytes, std::uint8_t>> datagrams(std::uint64_t count) {
  std::vector<std::pair<mxtp::Bytes, std::uint8_t>> out;
  const mxtp::Scale scale{{{"Head", {0, 0, 1.6F}}}, {{11, 1, "pRightTopOfHand", 0, {0, -0.18F, 0}}}};
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto h = header_of(k, 100.0, 0xffffffe0U, 86'399'900);
    for (auto& part : mxtp::encode_poses(h, body_items(k), k % 2 ? 2040 : 300))
      out.emplace_back(std::move(part), k % 2 == 0 ? 0 : 2);
    if (k % 5 == 0) out.emplace_back(mxtp::encode_center_of_mass(h, {{0, 0, 1}}), 0);
    if (k % 7 == 0) out.emplace_back(mxtp::encode_poses_euler(h, body_items(k))[0], 0);
    if (k == 2) out.emplace_back(mxtp::encode_meta(h, {{{"name", "Anna"}}}), 0);
    if (k == 3) out.emplace_back(mxtp::encode_time_code(h, {"12:34:56.789"}), 0);
    if (k == 4)
      for (auto& part : mxtp::encode_scale(h, scale, 60)) out.emplace_back(std::move(part), 0);
  }
  return out;
}

void write_datagrams(const fs::path& folder) {
  for (const std::uint64_t count : {1U, 6U, 60U}) {
    BigEndianWriter w;
    for (const auto& [bytes, wait] : datagrams(count)) {
      w.u16(static_cast<std::uint16_t>(bytes.size()));
      w.u8(0);
      w.u8(wait);
      w.bytes(bytes);
    }
    const auto all = w.release();
    write(folder / ("stream-" + std::to_string(count)), {reinterpret_cast<const char*>(all.data()), all.size()});
  }
}

void write_recordings(const fs::path& folder) {
  fs::create_directories(folder / "pcap");
  auto pcap = PcapWriter::create((folder / "pcap" / "stream").string(), 9763);
  if (!pcap) std::abort();
  double time_s = 0.0;
  for (const auto& [bytes, wait] : datagrams(6)) pcap->write(time_s += 0.01, bytes);
  pcap->close();
  write(folder / "mvnx" / "version-4", mvnx({4, true}, 3));
  write(folder / "mvnx" / "version-3", mvnx({3, false}, 2));
}

void write_journal(const fs::path& folder) {
  KeyPose pose;
  pose.T_odom_pelvis = {{1, 2, 0.9}, Eigen::Quaterniond::Identity()};
  pose.p_pelvis_stance = Eigen::Vector3d(0, 0.1, -0.9);
  KeyPose next = pose;
  next.id = 1;
  next.time_s = 1.0;
  next.field_disturbed = true;
  next.slip = Slip{-0.01, {0.002, 0.001}, 0.75, 0.003};
  const std::vector<journal::Entry> entries{
      journal::SessionStart{"20261122T103303Z", 1795343583000, "0.1.0", journal::kVersion},
      WearerInfo{"Ada", Eigen::Vector3d(0, -0.18, 0), std::nullopt, 1.7},
      pose,
      Trace{0.0, 2.0, 1.7, {{0.5, 0, pose.T_odom_pelvis}, {0.6, 0, pose.T_odom_pelvis}}},
      next,
      UnfinishedTrace{0.0, 0.7, true, {}, 1.7, {{0.5, 0, pose.T_odom_pelvis}}},
      UnfinishedSitting{1.5, 2.0, 0.4, 0.4, true, true, {0.5, 0, 0}, {{1.6, 1, pose.T_odom_pelvis, 0.45}}},
      Pivot{1.0, 1.5, {0, -0.1, 0}, Eigen::Matrix3d::Identity(), {}},
      Sitting{1.5, 4.0, 1, pose.T_odom_pelvis, 0.45, 0.01},
      journal::StreamMark{4.0, 480, 1795343587000, 36000000U, pose.T_odom_pelvis, 0.1, 0.2},
      journal::StreamSilence{}};
  std::string whole = journal::header();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    whole += journal::record(entries[i]);
    write(folder / ("entry-" + std::to_string(i)), 'E' + journal::encode(entries[i]));
  }
  write(folder / "whole", whole);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path folder = argv[1];
  write_datagrams(folder / "datagrams");
  write_recordings(folder);
  write_journal(folder / "journal");
  write(folder / "config" / "default", to_json(Config{}).dump(1));
  return 0;
}
