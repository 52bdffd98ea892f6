// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/journal_file.hpp"
#include "daemon/recorder.hpp"
#include "daemon/session_store.hpp"

namespace kinemap {

/// The session under way on disk: found again at the start, written while it lasts, old ones removed.
class SessionJournal {
 public:
  /// The Error is for people: what is wrong with the directory.
  static Result<std::unique_ptr<SessionJournal>> open(const std::filesystem::path& directory,
                                                      const Config::Journal& config);

  /// The newest session, once; nullopt when there is none (any more).
  std::optional<StoredSession> take_stored() { return std::exchange(stored_, std::nullopt); }
  /// For a session that begins now. Any thread.
  [[nodiscard]] std::string new_id(std::int64_t unix_ms) const { return store_.new_id(unix_ms); }
  /// Where the mapper's state may be kept beside that session's journal. Any thread.
  [[nodiscard]] std::filesystem::path checkpoint_of(const std::string& id) const {
    return store_.files().checkpoint_of(id);
  }
  [[nodiscard]] std::uint64_t min_free_bytes() const;

  /// Goes on with the stored session, or begins another one with a SessionStart. One thread.
  void append(const journal::Entry& entry);
  /// Now and then, while there is nothing to append: tries again to write what the disk refused.
  void retry() {
    if (file_) file_->retry();
  }
  [[nodiscard]] JournalStats stats() const;
  /// Null where the suit is not recorded. Its own threads' rules hold.
  [[nodiscard]] Recorder* recorder() const { return recorder_.get(); }

 private:
  SessionJournal(SessionStore store, const Config::Journal& config);
  void begin(const std::string& id, std::uint64_t length);
  bool make_room(const std::string& current) const;

  SessionStore store_;
  Config::Journal config_;
  std::optional<StoredSession> stored_;
  std::string id_;
  std::unique_ptr<JournalFile> file_;
  std::unique_ptr<Recorder> recorder_;  // last: ends before what it asks
};

}  // namespace kinemap
