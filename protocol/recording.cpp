// SPDX-License-Identifier: Apache-2.0
#include "protocol/recording.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "protocol/mvnx.hpp"
#include "protocol/wire/file.hpp"
#include "protocol/wire/pcap.hpp"

namespace kinemap {

namespace {

constexpr std::uint64_t kProgressEvery = 1 << 20;  // bytes

/// The first bytes of a file; an Error when it cannot be read or is empty.
Result<std::string> first_bytes(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return Error{path + ": cannot open: " + std::strerror(errno)};
  std::string head(256, '\0');
  head.resize(std::fread(head.data(), 1, head.size(), file.get()));
  if (std::ferror(file.get())) return Error{path + ": cannot read: " + std::strerror(errno)};
  if (head.empty()) return Error{path + ": is empty"};
  return head;
}

/// XML: a byte order mark and blanks may come before the first tag.
bool looks_like_xml(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  const std::size_t at = head.find_first_not_of(" \t\r\n");
  return (at != std::string_view::npos && head[at] == '<') || head.starts_with("\xff\xfe") ||
         head.starts_with("\xfe\xff");
}

bool is_mxtp(const UdpPacket& packet) {
  constexpr std::string_view kMagic = "MXTP";
  return packet.payload.size() >= kMagic.size() &&
         std::memcmp(packet.payload.data(), kMagic.data(), kMagic.size()) == 0;
}

/// Plays a capture into an Assembler.
class PcapPlayer {
 public:
  PcapPlayer(const AssemblerConfig& config, const RecordingSink& sink) : assembler_(config), sink_(&sink) {}

  Result<RecordingSummary> play(const std::string& path, PcapReader reader, const Progress& progress) {
    std::uint64_t reported = 0;
    for (;;) {
      auto packet = reader.next();
      if (!packet) {
        summary_.warnings.push_back(packet.error() + "; what came before was used");
        break;
      }
      if (!*packet) break;
      take(**packet);
      if (progress && reader.stats().bytes_read - reported >= kProgressEvery) {
        reported = reader.stats().bytes_read;
        progress(std::min(
            1.0, static_cast<double>(reported) / static_cast<double>(std::max<std::uint64_t>(reader.file_size(), 1))));
      }
    }
    assembler_.flush([this](const SuitFrame& f) { on_frame(f); });
    if (progress) progress(1.0);
    return finish(path, reader.stats());
  }

 private:
  void take(const UdpPacket& packet) {
    if (!is_mxtp(packet)) return;
    ++mxtp_;
    assembler_.add(packet.payload, packet.time_s, packet.source, [this](const SuitFrame& f) { on_frame(f); });
    tell_wearer();
    if (assembler_.refusal() && (refusals_.empty() || refusals_.back() != *assembler_.refusal())) {
      refusals_.push_back(*assembler_.refusal());
    }
  }
  void tell_wearer() {
    if (assembler_.wearer_revision() == told_) return;
    told_ = assembler_.wearer_revision();
    if (sink_->on_wearer) sink_->on_wearer(assembler_.wearer());
  }
  void on_frame(const SuitFrame& frame) {
    tell_wearer();
    summary_.duration_s = frame.time_s;
    if (sink_->on_frame) sink_->on_frame(frame);
  }

  Result<RecordingSummary> finish(const std::string& path, const PcapStats& pcap) {
    summary_.format = "pcap";
    summary_.wearer = assembler_.wearer();
    summary_.rate_hz = assembler_.rate_hz();
    summary_.stream = assembler_.stats();
    if (summary_.stream.frames == 0) return nothing(path, pcap);
    for (const std::string& refusal : refusals_)
      summary_.warnings.push_back("part of the stream was refused: " + refusal);
    if (pcap.truncated > 0) {
      summary_.warnings.push_back(std::to_string(pcap.truncated) +
                                  " packets were cut short by the capture (record with: tcpdump -s 0)");
    }
    if (pcap.fragments_unfinished > 0) {
      summary_.warnings.push_back(std::to_string(pcap.fragments_unfinished) + " fragmented datagrams lack a part");
    }
    return std::move(summary_);
  }
  [[nodiscard]] Error nothing(const std::string& path, const PcapStats& pcap) const {
    std::string why = path + ": no wearer to map: ";
    if (!refusals_.empty()) {
      why += refusals_.back();
    } else if (mxtp_ == 0) {
      why += std::to_string(pcap.records) + " packets, of which none carries MXTP over UDP";
    } else {
      why += "none of " + std::to_string(mxtp_) + " MXTP datagrams gave a whole body";
      const auto& s = summary_.stream;
      if (s.not_a_person > 0) why += " (" + std::to_string(s.not_a_person) + " are of tracked objects)";
      if (s.other_character > 0) why += " (" + std::to_string(s.other_character) + " are of other characters)";
    }
    for (const std::string& w : summary_.warnings) why += "; " + w;
    return {why};
  }

  Assembler assembler_;
  const RecordingSink* sink_;
  RecordingSummary summary_;
  std::uint64_t told_ = 0;
  std::uint64_t mxtp_ = 0;
  std::vector<std::string> refusals_;
};

}  // namespace

Result<RecordingSummary> read_recording(const std::string& path, const AssemblerConfig& config,
                                        const RecordingSink& sink, const Progress& progress) {
  const auto head = first_bytes(path);
  if (!head) return Error{head.error()};
  if (looks_like_xml(*head)) return read_mvnx(path, config, sink, progress);
  auto reader = PcapReader::open(path);
  if (!reader) return Error{reader.error() + "; a .pcap or .mvnx recording is expected"};
  return PcapPlayer(config, sink).play(path, std::move(*reader), progress);
}

}  // namespace kinemap
