// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace kinemap {

/// A file that is only appended to, on a disk that may be full or gone. What the disk refuses waits in memory and is
/// tried again with the next call; whoever writes never stops for it. One thread.
class AppendFile {
 public:
  struct Limits {
    std::uint64_t min_free_bytes = 0;                       ///< less free space counts as a full disk
    std::uint64_t max_waiting_bytes = 64ULL * 1024 * 1024;  ///< days of key poses
  };

  /// `length`: of what is sound in an existing file; the rest is cut off. 0: a new file. Nothing is opened before the
  /// first `append`. `subject` begins the messages in the log: "journal".
  AppendFile(std::string subject, std::filesystem::path path, std::uint64_t length, const Limits& limits);
  /// Tries once more to write what waits.
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// False when too much waits already: the bytes are given up, whole. Empty bytes: only tries to write what waits.
  bool append(std::string_view bytes);
  /// Returns when all that was written is on the disk.
  void sync();

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  ///< length of the file
  [[nodiscard]] std::uint64_t waiting_bytes() const { return waiting_.size(); }
  /// False: the disk does not take what it is given.
  [[nodiscard]] bool healthy() const { return healthy_; }
  [[nodiscard]] bool unsynced() const { return unsynced_; }

 private:
  [[nodiscard]] std::optional<std::string> open();
  [[nodiscard]] std::optional<std::string> write_all();
  void report(const std::optional<std::string>& problem);

  std::string subject_;
  std::filesystem::path path_;
  Limits limits_;
  int fd_ = -1;
  std::string waiting_;
  std::uint64_t bytes_;
  bool healthy_ = true, unsynced_ = false, gave_up_ = false;
};

}  // namespace kinemap
