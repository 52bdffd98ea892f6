// SPDX-License-Identifier: Apache-2.0
#include "protocol/recording.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
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

/// The files of a directory, or the path itself.
Result<std::vector<std::string>> files_of(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) return std::vector<std::string>{path};
  std::vector<std::string> files;
  for (auto it = fs::directory_iterator(path, error); !error && it != fs::end(it); it.increment(error))
    if (it->path().extension() == ".pcap") files.push_back(it->path().string());
  std::sort(files.begin(), files.end());
  if (files.empty()) return Error{path + ": is a directory without .pcap files"};
  return files;
}

double size_of(const std::vector<std::string>& files) {
  double bytes = 0.0;
  std::error_code error;
  for (const auto& file : files) {
    const auto size = std::filesystem::file_size(file, error);
    if (!error) bytes += static_cast<double>(size);
  }
  return bytes;
}

/// Plays captures into an Assembler.
class PcapPlayer {
 public:
  PcapPlayer(const AssemblerConfig& config, const RecordingSink& sink) : assembler_(config), sink_(&sink) {}

  Result<RecordingSummary> play(const std::vector<std::string>& files, const Progress& progress) {
    const double all = std::max(size_of(files), 1.0);
    double before = 0.0;
    std::string unreadable;
    for (const std::string& file : files) {
      auto reader = PcapReader::open(file);
      if (!reader) {
        unreadable = reader.error();
        summary_.warnings.push_back(unreadable + "; it is left out");
        continue;
      }
      ++opened_;
      play(*reader, [&](double bytes) {
        if (progress) progress(std::min(1.0, (before + bytes) / all));
      });
      before += static_cast<double>(reader->file_size());
    }
    if (opened_ == 0) return Error{unreadable + "; a .pcap or .mvnx recording is expected"};
    assembler_.flush([this](const SuitFrame& f) { on_frame(f); });
    if (progress) progress(1.0);
    return finish(files.size() == 1 ? files.front()
                                    : std::to_string(files.size()) + " recordings, " + files.front() + " …");
  }

 private:
  void play(PcapReader& reader, const std::function<void(double)>& bytes_read) {
    std::uint64_t reported = 0;
    for (;;) {
      auto packet = reader.next();
      if (!packet) summary_.warnings.push_back(packet.error() + "; what came before was used");
      if (!packet || !*packet) break;
      take(**packet);
      if (reader.stats().bytes_read - reported < kProgressEvery) continue;
      reported = reader.stats().bytes_read;
      bytes_read(static_cast<double>(reported));
    }
    records_ += reader.stats().records;
    truncated_ += reader.stats().truncated;
    fragments_unfinished_ += reader.stats().fragments_unfinished;
  }
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

  Result<RecordingSummary> finish(const std::string& path) {
    summary_.format = "pcap";
    summary_.wearer = assembler_.wearer();
    summary_.rate_hz = assembler_.rate_hz();
    summary_.stream = assembler_.stats();
    if (summary_.stream.frames == 0) return nothing(path);
    for (const std::string& refusal : refusals_)
      summary_.warnings.push_back("part of the stream was refused: " + refusal);
    if (truncated_ > 0) {
      summary_.warnings.push_back(std::to_string(truncated_) +
                                  " packets were cut short by the capture (record with: tcpdump -s 0)");
    }
    if (fragments_unfinished_ > 0) {
      summary_.warnings.push_back(std::to_string(fragments_unfinished_) + " fragmented datagrams lack a part");
    }
    return std::move(summary_);
  }
  [[nodiscard]] Error nothing(const std::string& path) const {
    std::string why = path + ": no wearer to map: ";
    if (!refusals_.empty()) {
      why += refusals_.back();
    } else if (mxtp_ == 0) {
      why += std::to_string(records_) + " packets, of which none carries MXTP over UDP";
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
  std::uint64_t mxtp_ = 0, records_ = 0, truncated_ = 0, fragments_unfinished_ = 0;
  std::size_t opened_ = 0;
  std::vector<std::string> refusals_;
};

}  // namespace

Result<RecordingSummary> read_recording(const std::string& path, const AssemblerConfig& config,
                                        const RecordingSink& sink, const Progress& progress) {
  return read_recordings({path}, config, sink, progress);
}

Result<RecordingSummary> read_recordings(const std::vector<std::string>& paths, const AssemblerConfig& config,
                                         const RecordingSink& sink, const Progress& progress) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    const auto more = files_of(path);
    if (!more) return Error{more.error()};
    files.insert(files.end(), more->begin(), more->end());
  }
  if (files.size() == 1) {
    const auto head = first_bytes(files.front());
    if (!head) return Error{head.error()};
    if (looks_like_xml(*head)) return read_mvnx(files.front(), config, sink, progress);
  }
  return PcapPlayer(config, sink).play(files, progress);
}

}  // namespace kinemap
