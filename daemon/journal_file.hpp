// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "protocol/journal.hpp"

namespace kinemap {

struct JournalStats {
  std::uint64_t entries = 0;        ///< handed over since the start
  std::uint64_t bytes = 0;          ///< length of the file
  std::uint64_t waiting_bytes = 0;  ///< could not be written yet
  std::uint64_t lost_entries = 0;   ///< given up since too much was waiting
  std::uint64_t syncs = 0;          ///< times that the disk said it has it all
  double longest_sync_s = 0.0;
  bool healthy = true;  ///< false: the disk does not take what it is given; mapping goes on in memory
};

/// The journal of the session under way, appended to. What the disk refuses (full, gone) waits in memory and is tried
/// again with the next entry; the mapping never stops for it. One thread.
class JournalFile {
 public:
  struct Limits {
    std::uint64_t min_free_bytes = 0;                       ///< less free space counts as a full disk
    std::uint64_t max_waiting_bytes = 64ULL * 1024 * 1024;  ///< days of key poses
    std::chrono::milliseconds sync_every{1000};  ///< key poses of at most this time are lost with the battery
  };

  /// `length`: of what is sound in an existing file; the rest is cut off. 0: a new file.
  JournalFile(std::filesystem::path path, std::uint64_t length, const Limits& limits);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// Returns when the entry is on the disk (traces, seats and all else that maps are made of) or with the operating
  /// system (key poses, which are synced once in `sync_every`); or, with `healthy` false, when it waits in memory.
  void append(const journal::Entry& entry);

  [[nodiscard]] const JournalStats& stats() const { return stats_; }

 private:
  void write();
  void sync();
  [[nodiscard]] std::optional<std::string> open();
  [[nodiscard]] std::optional<std::string> write_all();
  void report(const std::optional<std::string>& problem);

  std::filesystem::path path_;
  Limits limits_;
  int fd_ = -1;
  std::string waiting_;
  std::uint64_t waiting_entries_ = 0;
  bool unsynced_ = false;
  std::chrono::steady_clock::time_point next_sync_;
  JournalStats stats_;
};

}  // namespace kinemap
