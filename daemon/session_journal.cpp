// SPDX-License-Identifier: Apache-2.0
#include "daemon/session_journal.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

namespace kinemap {

Result<std::unique_ptr<SessionJournal>> SessionJournal::open(const std::filesystem::path& directory,
                                                             const Config::Journal& config) {
  auto store = SessionStore::open(directory);
  if (!store) return Error{store.error()};
  return std::unique_ptr<SessionJournal>(new SessionJournal(*std::move(store), config));
}

SessionJournal::SessionJournal(SessionStore store, const Config::Journal& config)
    : store_(std::move(store)), config_(config), stored_(store_.last()) {
  if (stored_) begin(stored_->id, stored_->bytes);
}

void SessionJournal::append(const journal::Entry& entry) {
  if (const auto* start = std::get_if<journal::SessionStart>(&entry)) {
    begin(start->id, 0);
    spdlog::info("journal: session {} begins", start->id);
  }
  if (file_) file_->append(entry);
}

void SessionJournal::begin(const std::string& id, std::uint64_t length) {
  file_.reset();  // what waits of the session before is written first
  store_.begin(id);
  JournalFile::Limits limits;
  limits.min_free_bytes = static_cast<std::uint64_t>(config_.min_free_mb * 1024.0 * 1024.0);
  file_ = std::make_unique<JournalFile>(store_.files().journal_of(id), length, limits);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  for (const auto& removed : store_.retain(config_, id, std::chrono::duration_cast<std::chrono::seconds>(now).count()))
    spdlog::info("journal: session {} was removed (journal.keep_days, journal.keep_mb)", removed);
}

}  // namespace kinemap
