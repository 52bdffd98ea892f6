// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "protocol/journal.hpp"

namespace kinemap {

/// A session's place on the disk.
struct SessionInfo {
  std::string id;
  std::uint64_t bytes = 0;     ///< of all its files
  std::int64_t changed_s = 0;  ///< last written, seconds since 1970
};

/// Where sessions lie, for the daemon that writes them and the tools that look at them: `sessions/ID/journal.kjr` each,
/// with a checkpoint of the mapper and the recordings of the suit beside it; `quarantine/ID.kjr` for journals that were
/// damaged, as they were found; and `lock`.
class SessionFiles {
 public:
  explicit SessionFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}

  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
  [[nodiscard]] std::filesystem::path folder_of(const std::string& id) const { return directory_ / "sessions" / id; }
  [[nodiscard]] std::filesystem::path journal_of(const std::string& id) const { return folder_of(id) / "journal.kjr"; }
  [[nodiscard]] std::filesystem::path checkpoint_of(const std::string& id) const {
    return folder_of(id) / "checkpoint";
  }
  [[nodiscard]] std::filesystem::path quarantine() const { return directory_ / "quarantine"; }
  [[nodiscard]] std::filesystem::path quarantined(const std::string& id) const { return quarantine() / (id + ".kjr"); }

  [[nodiscard]] std::vector<SessionInfo> sessions() const;     ///< oldest first
  [[nodiscard]] std::vector<SessionInfo> quarantines() const;  ///< damaged journals, oldest first
  [[nodiscard]] std::uint64_t bytes() const;                   ///< of all of them

 private:
  std::filesystem::path directory_;
};

/// The recordings of the suit in a folder, in the order in which they were written.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder);

/// The file `lock` of a directory of sessions: held by whoever changes them, until its end, however that comes. The
/// daemon writes into it which session is under way, which is also how it finds that session again.
class SessionLock {
 public:
  /// nullopt when another process holds it (after a second of patience: one that is ending is waited for). The Error
  /// says why the file cannot be made.
  static Result<std::optional<SessionLock>> take(const std::filesystem::path& directory);
  SessionLock(SessionLock&& other) noexcept;
  SessionLock& operator=(SessionLock&&) = delete;
  ~SessionLock();

  /// The session under way, which is then on the disk.
  void name(const std::string& id) const;

  /// Which session is, or was last, under way; empty: none.
  static std::string named(const std::filesystem::path& directory);
  /// Whether somebody holds the lock now.
  static bool held(const std::filesystem::path& directory);

 private:
  explicit SessionLock(int file) : file_(file) {}
  int file_;
};

/// A journal as far as it can be read, mended for the mapper.
struct ReadJournal {
  journal::Contents contents;
  journal::Mended mended;
  [[nodiscard]] bool damaged() const {
    return !contents.damage.empty() || mended.key_poses_missing > 0 || mended.entries_left_out > 0;
  }
};

/// The Error names the file and why nothing of it can be read.
Result<ReadJournal> read_journal(const std::filesystem::path& path);

}  // namespace kinemap
