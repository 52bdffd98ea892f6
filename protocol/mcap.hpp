// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// MCAP, Foxglove's recording format (mcap.dev/spec, version 0), as far as a writer needs it: chunks that are not
/// compressed, with their checksums, message indexes and a summary.
namespace kinemap::mcap {

struct Channel {
  std::string topic;
  std::string encoding;  ///< of the messages: "json"
  std::string schema_name;
  std::string schema_encoding;  ///< "jsonschema"
  std::string schema;
};

/// Writes a recording front to back. All that is in whole chunks can be read from a file that was cut short.
class Writer {
 public:
  /// Takes the bytes of the file in their order.
  using Sink = std::function<void(std::string_view)>;

  /// `library`: who writes. All channels are known from the start; a message names its channel by its index.
  Writer(Sink sink, const std::string& library, std::vector<Channel> channels);
  /// Times in ns; messages best come in the order of time.
  void write(std::size_t channel, std::uint64_t time_ns, std::string_view data);
  /// Ends the file; nothing may be written after it.
  void finish();

 private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset;  ///< in the chunk
  };
  struct TimeRange {
    std::uint64_t first = 0, last = 0;
    void add(std::uint64_t time_ns, bool only);
  };

  void put(std::string_view bytes);
  void close_chunk();
  [[nodiscard]] std::string chunk_record() const;
  [[nodiscard]] std::string statistics() const;

  Sink sink_;
  std::vector<Channel> channels_;
  std::uint64_t position_ = 0;  // in the file

  std::string chunk_;
  TimeRange chunk_times_;
  std::vector<std::vector<IndexEntry>> chunk_index_;  // of each channel

  std::string chunk_indexes_;  // records for the summary
  std::uint32_t chunks_ = 0;
  TimeRange times_;
  std::vector<std::uint64_t> counts_;  // messages of each channel
};

}  // namespace kinemap::mcap
