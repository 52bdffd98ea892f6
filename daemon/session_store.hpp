// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "daemon/session_files.hpp"
#include "protocol/journal.hpp"

namespace kinemap {

/// A session that can go on: all that the mapper was told of it.
struct StoredSession {
  std::string id;
  std::vector<journal::Entry> entries;  ///< mended: the mapper can take them
  std::uint64_t bytes = 0;              ///< of its journal
};

/// The daemon's hand on the folder of all sessions: one daemon at a time.
class SessionStore {
 public:
  /// Creates the folder where it is missing. The Error says what is wrong with it and which key to change.
  static Result<SessionStore> open(const std::filesystem::path& directory);

  /// The session that was under way last, or the newest. A damaged journal is moved to quarantine, and what can be read
  /// of it is put in its place; one of an older format is written anew in the current one; one that cannot be read at
  /// all stays where it is. All that is said in the log.
  std::optional<StoredSession> last();

  /// This session is under way from now on.
  void begin(const std::string& id) { lock_.name(id); }

  /// A new id for a session that begins now: UTC, "20261122T103303Z".
  [[nodiscard]] std::string new_id(std::int64_t unix_ms) const;
  [[nodiscard]] const SessionFiles& files() const { return files_; }

  /// Removes the oldest sessions, and the quarantine, beyond the age and the size that are to be kept; never `current`.
  /// The ids removed.
  std::vector<std::string> retain(const Config::Journal& config, const std::string& current, std::int64_t now_s) const;

 private:
  SessionStore(SessionFiles files, SessionLock lock) : files_(std::move(files)), lock_(std::move(lock)) {}
  /// Writes the journal anew: mended, in the current format.
  bool rewrite(const std::string& id, const ReadJournal& read, StoredSession& session) const;

  SessionFiles files_;
  SessionLock lock_;
};

}  // namespace kinemap
