// SPDX-License-Identifier: Apache-2.0
#include "daemon/session_journal.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <utility>

namespace kinemap {
namespace {

std::uint64_t bytes(double mebibytes) { return static_cast<std::uint64_t>(mebibytes * 1024.0 * 1024.0); }

}  // namespace

Result<std::unique_ptr<SessionJournal>> SessionJournal::open(const std::filesystem::path& directory,
                                                             const Config::Journal& config) {
  auto store = SessionStore::open(directory);
  if (!store) return Error{store.error()};
  return std::unique_ptr<SessionJournal>(new SessionJournal(*std::move(store), config));
}

SessionJournal::SessionJournal(SessionStore store, const Config::Journal& config)
    : store_(std::move(store)), config_(config), stored_(store_.last()) {
  if (config.record) {
    Recorder::Limits limits;
    limits.min_free_bytes = min_free_bytes();
    limits.max_file_bytes = bytes(config.record_file_mb);
    limits.max_file_age = std::chrono::seconds(std::lround(60.0 * config.record_file_min));
    recorder_ = std::make_unique<Recorder>(
        limits, [this](const std::filesystem::path& folder) { return make_room(folder.filename().string()); });
  }
  if (stored_) begin(stored_->id, stored_->bytes);
}

std::uint64_t SessionJournal::min_free_bytes() const { return bytes(config_.min_free_mb); }

void SessionJournal::append(const journal::Entry& entry) {
  if (const auto* start = std::get_if<journal::SessionStart>(&entry)) {
    begin(start->id, 0);
    spdlog::info("journal: session {} begins", start->id);
  }
  if (file_) file_->append(entry);
  // Only with the first entry it is clear that the stored session goes on.
  if (recorder_ && file_) recorder_->begin(store_.files().folder_of(id_));
}

JournalStats SessionJournal::stats() const {
  JournalStats stats = file_ ? file_->stats() : JournalStats{};
  std::error_code ignored;
  if (const auto space = std::filesystem::space(store_.files().directory(), ignored); !ignored)
    stats.free_bytes = space.available;
  stats.min_free_bytes = bytes(config_.min_free_mb);
  return stats;
}

void SessionJournal::begin(const std::string& id, std::uint64_t length) {
  file_.reset();  // what waits of the session before is written first
  id_ = id;
  store_.begin(id);
  JournalFile::Limits limits;
  limits.min_free_bytes = min_free_bytes();
  file_ = std::make_unique<JournalFile>(store_.files().journal_of(id), length, limits);
  make_room(id);
}

/// Removes what is beyond the budget, but for the current session; false when that one alone is.
bool SessionJournal::make_room(const std::string& current) const {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  for (const auto& removed :
       store_.retain(config_, current, std::chrono::duration_cast<std::chrono::seconds>(now).count()))
    spdlog::info("journal: session {} was removed (journal.keep_days, journal.keep_mb)", removed);
  return store_.files().bytes() <= bytes(config_.keep_mb);
}

}  // namespace kinemap
