// SPDX-License-Identifier: Apache-2.0
#include "daemon/session_store.hpp"

#include <spdlog/spdlog.h>

#include <ctime>
#include <fstream>
#include <system_error>
#include <utility>

namespace kinemap {
namespace {

namespace fs = std::filesystem;

/// Puts `bytes` in the place of the file, whole or not at all.
bool replace_file(const fs::path& path, const std::string& bytes) {
  const fs::path fresh = path.string() + ".new";
  std::ofstream out(fresh, std::ios::binary);
  out << bytes;
  out.close();
  std::error_code error;
  if (out) fs::rename(fresh, path, error);
  return out && !error;
}

}  // namespace

Result<SessionStore> SessionStore::open(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory / "sessions", error);
  if (error) return Error{"journal.directory: " + directory.string() + " cannot be made: " + error.message()};
  auto lock = SessionLock::take(directory);
  if (!lock) return Error{"journal.directory: " + lock.error()};
  if (!*lock)
    return Error{"journal.directory: another kinemapd keeps its sessions in " + directory.string() +
                 "; end it, or give this one a directory of its own"};
  return SessionStore(SessionFiles(directory), **std::move(lock));
}

std::string SessionStore::new_id(std::int64_t unix_ms) const {
  const std::time_t seconds = unix_ms / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  std::string id = text;
  for (char suffix = 'b'; fs::exists(files_.folder_of(id)) && suffix <= 'z'; ++suffix) id = std::string(text) + suffix;
  return id;
}

std::optional<StoredSession> SessionStore::last() {
  const auto sessions = files_.sessions();
  if (sessions.empty()) return std::nullopt;
  const std::string named = SessionLock::named(files_.directory());
  const bool there = !named.empty() && fs::exists(files_.journal_of(named));
  StoredSession session{there ? named : sessions.back().id, {}, 0};
  const auto path = files_.journal_of(session.id);
  auto read = read_journal(path);
  if (!read) {
    spdlog::error("journal: {}; it stays where it is, and a new session begins", read.error());
    return std::nullopt;
  }
  if (read->contents.torn_bytes > 0)
    spdlog::info("journal: the last {} bytes of {} were being written when the power went; they are left out",
                 read->contents.torn_bytes, path.string());
  session.bytes = read->contents.sound_bytes;
  const bool old = read->contents.version < journal::kVersion;
  if ((read->damaged() || old) && !rewrite(session.id, *read, session)) return std::nullopt;
  session.entries = std::move(read->contents.entries);
  return session;
}

bool SessionStore::rewrite(const std::string& id, const ReadJournal& read, StoredSession& session) const {
  const auto path = files_.journal_of(id);
  std::error_code error;
  if (read.damaged()) {
    fs::create_directories(files_.quarantine(), error);
    fs::copy_file(path, files_.quarantined(id), fs::copy_options::overwrite_existing, error);
  }
  const std::string sound = journal::file_of(read.contents.entries);
  if (error || !replace_file(path, sound)) {
    spdlog::error("journal: {} {} and could not be written anew; a new session begins", path.string(),
                  read.damaged() ? "is damaged" : "is of an older format");
    return false;
  }
  session.bytes = sound.size();
  if (read.damaged())
    spdlog::error(
        "journal: {} was damaged in {} places; {} entries could be read, {} key poses and {} traces or seats are "
        "missing; the damaged file is in {}",
        path.string(), read.contents.damage.size(), read.contents.entries.size(), read.mended.key_poses_missing,
        read.mended.entries_left_out, files_.quarantine().string());
  else
    spdlog::info("journal: {} was of format {} and is of format {} now", path.string(), read.contents.version,
                 journal::kVersion);
  return true;
}

std::vector<std::string> SessionStore::retain(const Config::Journal& config, const std::string& current,
                                              std::int64_t now_s) const {
  struct Old {
    fs::path path;
    SessionInfo info;
  };
  std::vector<Old> old;  // oldest first
  std::uint64_t total = 0;
  for (const auto& info : files_.quarantines()) {
    total += info.bytes;
    old.push_back({files_.quarantined(info.id), info});
  }
  for (const auto& info : files_.sessions()) {
    total += info.bytes;
    if (info.id != current) old.push_back({files_.folder_of(info.id), info});
  }
  const auto keep_s = static_cast<std::int64_t>(config.keep_days * 86400.0);
  const auto keep_bytes = static_cast<std::uint64_t>(config.keep_mb * 1024.0 * 1024.0);
  std::vector<std::string> removed;
  for (const auto& [path, info] : old) {
    if (info.changed_s > now_s - keep_s && total <= keep_bytes) continue;
    std::error_code error;
    fs::remove_all(path, error);
    if (error) continue;
    total -= info.bytes;
    removed.push_back(info.id);
  }
  return removed;
}

}  // namespace kinemap
