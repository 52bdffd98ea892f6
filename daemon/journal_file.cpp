// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal_file.hpp"

#include <algorithm>
#include <utility>

namespace kinemap {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

/// Key poses come by the dozen, each worth a step; all else is announced to others and must be safe before.
bool can_wait(const journal::Entry& entry) {
  return std::holds_alternative<KeyPose>(entry) || std::holds_alternative<journal::StreamMark>(entry) ||
         std::holds_alternative<journal::Announced>(entry) || journal::is_piece(entry);
}

}  // namespace

JournalFile::JournalFile(std::filesystem::path path, std::uint64_t length, const Limits& limits)
    : file_("journal", std::move(path), length, limits),
      sync_every_(limits.sync_every),
      next_sync_(Clock::now()),
      new_(length == 0) {}

JournalFile::~JournalFile() {
  file_.append({});
  sync();
}

void JournalFile::append(const journal::Entry& entry) {
  ++stats_.entries;
  ++stats_.unsafe_entries;
  if (stats_.unsafe_since_s < 0.0) stats_.unsafe_since_s = seconds(Clock::now());
  const std::string record =
      std::exchange(new_, false) ? journal::header() + journal::record(entry) : journal::record(entry);
  if (!file_.append(record)) ++stats_.lost_entries;  // a gap, which mend() closes when it is read
  if (!can_wait(entry) || Clock::now() >= next_sync_) sync();
}

void JournalFile::retry() {
  const bool refused = !file_.healthy();
  if (refused) file_.append({});
  if (file_.healthy() && (refused || Clock::now() >= next_sync_)) sync();
}

void JournalFile::sync() {
  if (!file_.unsynced()) return;
  const auto begin = Clock::now();
  file_.sync();
  if (file_.unsynced()) return;
  next_sync_ = Clock::now() + sync_every_;
  ++stats_.syncs;
  note_safe();
  stats_.longest_sync_s = std::max(stats_.longest_sync_s, std::chrono::duration<double>(Clock::now() - begin).count());
}

void JournalFile::note_safe() {
  if (file_.waiting_bytes() > 0) return;
  stats_.unsafe_entries = 0;
  stats_.unsafe_since_s = -1.0;
}

JournalStats JournalFile::stats() const {
  JournalStats stats = stats_;
  stats.bytes = file_.bytes();
  stats.waiting_bytes = file_.waiting_bytes();
  stats.healthy = file_.healthy();
  return stats;
}

}  // namespace kinemap
