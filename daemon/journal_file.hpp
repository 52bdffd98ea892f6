// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "daemon/append_file.hpp"
#include "protocol/journal.hpp"

namespace kinemap {

struct JournalStats {
  std::uint64_t entries = 0;        ///< of this daemon's life
  std::uint64_t bytes = 0;          ///< length of the file
  std::uint64_t waiting_bytes = 0;  ///< could not be written yet
  std::uint64_t lost_entries = 0;   ///< given up since too much was waiting
  std::uint64_t syncs = 0;          ///< times that the disk said it has it all
  double longest_sync_s = 0.0;
  bool healthy = true;               ///< false: the disk does not take what it is given; mapping goes on in memory
  std::uint64_t unsafe_entries = 0;  ///< that the disk has not said yet that it has
  double unsafe_since_s = -1.0;      ///< when the oldest of them came, s of the steady clock; negative: there is none
  std::uint64_t free_bytes = 0;      ///< of the disk
  std::uint64_t min_free_bytes = 0;  ///< with less, writing is suspended
};

/// The journal of the session under way, appended to. The mapping never stops for the disk (AppendFile). One thread.
class JournalFile {
 public:
  struct Limits : AppendFile::Limits {
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

  /// Tries again to write what the disk refused, and syncs what is due.
  void retry();

  [[nodiscard]] JournalStats stats() const;

 private:
  void sync();
  void note_safe();

  AppendFile file_;
  std::chrono::milliseconds sync_every_;
  std::chrono::steady_clock::time_point next_sync_;
  bool new_;  ///< the header is still to come
  JournalStats stats_;
};

}  // namespace kinemap
