// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "protocol/journal.hpp"

namespace kinemap {

/// A session that can go on: all that the mapper was told of it.
struct StoredSession {
  std::string id;
  std::vector<journal::Entry> entries;  ///< mended: the mapper can take them
  std::uint64_t bytes = 0;              ///< of its journal
};

struct SessionInfo {
  std::string id;
  std::uint64_t bytes = 0;     ///< of all its files
  std::int64_t changed_s = 0;  ///< last written, seconds since 1970
};

/// The folder of all sessions: `sessions/ID/journal.kjr` each, `quarantine/` for journals that were damaged. One daemon
/// at a time.
class SessionStore {
 public:
  /// Creates the folder where it is missing. The Error says what is wrong with it and which key to change.
  static Result<SessionStore> open(const std::filesystem::path& directory);
  ~SessionStore();
  SessionStore(SessionStore&& other) noexcept;
  SessionStore& operator=(SessionStore&&) = delete;

  /// The newest session. A damaged journal is moved to quarantine, and what can be read of it is put in its place; one
  /// that cannot be read at all stays where it is. All that is said in the log.
  std::optional<StoredSession> newest();

  /// A new id for a session that begins now: UTC, "20261122T103303Z".
  [[nodiscard]] std::string new_id(std::int64_t unix_ms) const;
  [[nodiscard]] std::filesystem::path journal_of(const std::string& id) const;
  [[nodiscard]] std::vector<SessionInfo> list() const;  ///< oldest first

  /// Removes the oldest sessions, and the quarantine, beyond the age and the size that are to be kept; never `current`.
  /// The ids removed.
  std::vector<std::string> retain(const Config::Journal& config, const std::string& current, std::int64_t now_s);

 private:
  explicit SessionStore(std::filesystem::path directory, int lock) : directory_(std::move(directory)), lock_(lock) {}
  [[nodiscard]] std::filesystem::path folder_of(const std::string& id) const { return directory_ / "sessions" / id; }

  std::filesystem::path directory_;
  int lock_ = -1;
};

}  // namespace kinemap
