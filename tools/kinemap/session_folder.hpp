// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "daemon/session_files.hpp"
#include "tools/kinemap/session_summary.hpp"

namespace kinemap::cli {

/// A session on the disk, or a damaged journal in quarantine, as far as it can be read.
struct StoredSession {
  enum class State { Open, Closed, Quarantined, Unreadable };
  std::string id;  ///< of one in quarantine: "quarantine/ID"
  State state = State::Closed;
  std::string path;  ///< of the journal
  std::uint64_t bytes = 0;
  std::vector<std::string> recordings;
  std::optional<ReadJournal> read;  ///< nothing when unreadable
  std::string problem;              ///< why it is
  SessionSummary summary;
  [[nodiscard]] bool readable() const { return read.has_value(); }
};

/// The sessions of a directory, for somebody who is not the daemon that keeps them.
class SessionFolder {
 public:
  explicit SessionFolder(const std::string& directory) : files_(directory) {}
  [[nodiscard]] const SessionFiles& files() const { return files_; }

  [[nodiscard]] std::vector<StoredSession> all() const;  ///< oldest first, then what is in quarantine
  [[nodiscard]] Result<StoredSession> find(const std::string& id) const;
  /// Refuses the one that a running daemon writes.
  [[nodiscard]] std::optional<Error> remove(const std::string& id) const;
  /// A new session of these entries; its id. Refuses one that is there. `path` is for the message.
  [[nodiscard]] Result<std::string> add(const std::vector<journal::Entry>& entries, const std::string& path) const;

 private:
  [[nodiscard]] StoredSession read(const SessionInfo& info, bool quarantined) const;

  SessionFiles files_;
};

/// The columns id, begin, duration, objects, distance, size, state.
std::vector<std::string> session_row(const StoredSession& session);
std::string session_text(const StoredSession& session);
nlohmann::ordered_json session_json(const StoredSession& session);
/// "damaged in 2 places (310 bytes), …".
std::string damage_text(const ReadJournal& read);

}  // namespace kinemap::cli
