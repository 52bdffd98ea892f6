// SPDX-License-Identifier: Apache-2.0
#include "protocol/mcap.hpp"

#include <algorithm>
#include <boost/crc.hpp>
#include <concepts>
#include <numeric>
#include <utility>

namespace kinemap::mcap {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = 256 * 1024;

enum class Op : std::uint8_t {
  Header = 0x01,
  Footer = 0x02,
  Schema = 0x03,
  Channel = 0x04,
  Message = 0x05,
  Chunk = 0x06,
  MessageIndex = 0x07,
  ChunkIndex = 0x08,
  Statistics = 0x0B,
  SummaryOffset = 0x0E,
  DataEnd = 0x0F,
};

/// The fields of one record, little-endian.
class Fields {
 public:
  template <std::unsigned_integral T>
  Fields& number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) text_ += static_cast<char>(value >> (8 * i) & 0xFFU);
    return *this;
  }
  Fields& string(std::string_view text) { return number(static_cast<std::uint32_t>(text.size())).bytes(text); }
  Fields& bytes(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string record(Op op, const Fields& fields) {
  Fields head;
  head.number(static_cast<std::uint8_t>(op)).number(static_cast<std::uint64_t>(fields.text().size()));
  return head.text() + fields.text();
}

std::uint32_t crc32(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::uint16_t id_of(std::size_t channel) { return static_cast<std::uint16_t>(channel + 1); }  // schema id 0 means none

/// Each channel has a schema of its own.
std::string schema_record(std::size_t id, const Channel& channel) {
  return record(
      Op::Schema,
      Fields().number(id_of(id)).string(channel.schema_name).string(channel.schema_encoding).string(channel.schema));
}

std::string channel_record(std::size_t id, const Channel& channel) {
  return record(Op::Channel,
                Fields().number(id_of(id)).number(id_of(id)).string(channel.topic).string(channel.encoding).string(""));
}

/// Where a group of summary records is, for readers that want only that.
std::string summary_offset(Op group, std::uint64_t start, std::uint64_t length) {
  if (length == 0) return {};
  return record(Op::SummaryOffset, Fields().number(static_cast<std::uint8_t>(group)).number(start).number(length));
}

}  // namespace

void Writer::TimeRange::add(std::uint64_t time_ns, bool only) {
  first = only ? time_ns : std::min(first, time_ns);
  last = only ? time_ns : std::max(last, time_ns);
}

Writer::Writer(Sink sink, const std::string& library, std::vector<Channel> channels)
    : sink_(std::move(sink)),
      channels_(std::move(channels)),
      chunk_index_(channels_.size()),
      counts_(channels_.size(), 0) {
  put(kMagic);
  put(record(Op::Header, Fields().string("").string(library)));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    put(schema_record(i, channels_[i]));
    put(channel_record(i, channels_[i]));
  }
}

void Writer::put(std::string_view bytes) {
  sink_(bytes);
  position_ += bytes.size();
}

void Writer::write(std::size_t channel, std::uint64_t time_ns, std::string_view data) {
  times_.add(time_ns, std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}) == 0);
  chunk_times_.add(time_ns, chunk_.empty());
  chunk_index_[channel].push_back({time_ns, chunk_.size()});
  const auto sequence = static_cast<std::uint32_t>(counts_[channel]++);
  chunk_ +=
      record(Op::Message, Fields().number(id_of(channel)).number(sequence).number(time_ns).number(time_ns).bytes(data));
  if (chunk_.size() >= kChunkBytes) close_chunk();
}

std::string Writer::chunk_record() const {
  const auto size = static_cast<std::uint64_t>(chunk_.size());
  return record(Op::Chunk, Fields()
                               .number(chunk_times_.first)
                               .number(chunk_times_.last)
                               .number(size)
                               .number(crc32(chunk_))
                               .string("")  // not compressed
                               .number(size)
                               .bytes(chunk_));
}

void Writer::close_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t chunk_at = position_;
  put(chunk_record());
  const std::uint64_t index_at = position_;
  Fields offsets;  // channel → where its index is
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (chunk_index_[i].empty()) continue;
    offsets.number(id_of(i)).number(position_);
    Fields entries;
    for (const IndexEntry& entry : chunk_index_[i]) entries.number(entry.time_ns).number(entry.offset);
    put(record(Op::MessageIndex, Fields().number(id_of(i)).string(entries.text())));
    chunk_index_[i].clear();
  }
  const auto size = static_cast<std::uint64_t>(chunk_.size());
  chunk_indexes_ += record(Op::ChunkIndex, Fields()
                                               .number(chunk_times_.first)
                                               .number(chunk_times_.last)
                                               .number(chunk_at)
                                               .number(index_at - chunk_at)
                                               .string(offsets.text())
                                               .number(position_ - index_at)
                                               .string("")
                                               .number(size)
                                               .number(size));
  ++chunks_;
  chunk_.clear();
}

std::string Writer::statistics() const {
  Fields counts;
  std::uint64_t messages = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    counts.number(id_of(i)).number(counts_[i]);
    messages += counts_[i];
  }
  const auto channels = static_cast<std::uint32_t>(channels_.size());
  return record(Op::Statistics, Fields()
                                    .number(messages)
                                    .number(static_cast<std::uint16_t>(channels))
                                    .number(channels)
                                    .number(std::uint32_t{0})  // attachments
                                    .number(std::uint32_t{0})  // metadata
                                    .number(chunks_)
                                    .number(times_.first)
                                    .number(times_.last)
                                    .string(counts.text()));
}

void Writer::finish() {
  close_chunk();
  put(record(Op::DataEnd, Fields().number(std::uint32_t{0})));  // 0: no checksum of the data as a whole
  const std::uint64_t start = position_;
  std::string summary, offsets;
  const auto add = [&](Op group, const std::string& records) {
    offsets += summary_offset(group, start + summary.size(), records.size());
    summary += records;
  };
  std::string schemas, channels;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    schemas += schema_record(i, channels_[i]);
    channels += channel_record(i, channels_[i]);
  }
  add(Op::Schema, schemas);
  add(Op::Channel, channels);
  add(Op::Statistics, statistics());
  add(Op::ChunkIndex, chunk_indexes_);
  // The checksum covers the summary and the footer up to itself.
  const std::string footer = record(
      Op::Footer,
      Fields().number(start).number(start + static_cast<std::uint64_t>(summary.size())).number(std::uint32_t{0}));
  summary += offsets + footer.substr(0, footer.size() - 4);
  put(summary);
  put(Fields().number(crc32(summary)).text());
  put(kMagic);
}

}  // namespace kinemap::mcap
