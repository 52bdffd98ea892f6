// SPDX-License-Identifier: Apache-2.0
#include "daemon/session_store.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace kinemap {
namespace {

namespace fs = std::filesystem;
constexpr const char* kJournal = "journal.kjr";

std::optional<std::string> text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) return std::nullopt;
  return std::move(text).str();
}

/// Size and last change of a folder's files.
SessionInfo info_of(const fs::path& folder) {
  SessionInfo info{folder.filename().string(), 0, 0};
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::end(it); it.increment(error)) {
    struct stat file {};
    if (::stat(it->path().c_str(), &file) != 0 || !S_ISREG(file.st_mode)) continue;
    info.bytes += static_cast<std::uint64_t>(file.st_size);
    info.changed_s = std::max<std::int64_t>(info.changed_s, file.st_mtime);
  }
  return info;
}

std::vector<SessionInfo> folders_in(const fs::path& directory) {
  std::vector<SessionInfo> list;
  std::error_code error;
  for (auto it = fs::directory_iterator(directory, error); !error && it != fs::end(it); it.increment(error))
    if (it->is_directory(error)) list.push_back(info_of(it->path()));
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return list;
}

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
  const auto lock_path = directory / "lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock < 0)
    return Error{"journal.directory: " + directory.string() +
                 " cannot be written: " + std::generic_category().message(errno)};
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return Error{"journal.directory: another kinemapd keeps its sessions in " + directory.string() +
                 "; end it, or give this one a directory of its own"};
  }
  return SessionStore(directory, lock);
}

SessionStore::SessionStore(SessionStore&& other) noexcept
    : directory_(std::move(other.directory_)), lock_(std::exchange(other.lock_, -1)) {}

SessionStore::~SessionStore() {
  if (lock_ >= 0) ::close(lock_);
}

std::filesystem::path SessionStore::journal_of(const std::string& id) const { return folder_of(id) / kJournal; }

std::vector<SessionInfo> SessionStore::list() const { return folders_in(directory_ / "sessions"); }

std::string SessionStore::new_id(std::int64_t unix_ms) const {
  const std::time_t seconds = unix_ms / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  std::string id = text;
  for (char suffix = 'b'; fs::exists(folder_of(id)) && suffix <= 'z'; ++suffix) id = std::string(text) + suffix;
  return id;
}

std::optional<StoredSession> SessionStore::newest() {
  const auto sessions = list();
  if (sessions.empty()) return std::nullopt;
  StoredSession session{sessions.back().id, {}, 0};
  const auto path = journal_of(session.id);
  const auto text = text_of(path);
  if (!text) {
    spdlog::error("journal: {} cannot be read; a new session begins", path.string());
    return std::nullopt;
  }
  auto contents = journal::read(*text, path.string());
  if (!contents) {
    spdlog::error("journal: {}; it stays where it is, and a new session begins", contents.error());
    return std::nullopt;
  }
  if (contents->torn_bytes > 0)
    spdlog::info("journal: the last {} bytes of {} were being written when the power went; they are left out",
                 contents->torn_bytes, path.string());
  session.entries = std::move(contents->entries);
  session.bytes = contents->sound_bytes;
  const auto mended = journal::mend(session.entries);
  if (contents->damage.empty() && mended.key_poses_missing == 0 && mended.entries_left_out == 0) return session;

  const auto quarantine = directory_ / "quarantine";
  std::error_code error;
  fs::create_directories(quarantine, error);
  fs::copy_file(path, quarantine / (session.id + ".kjr"), fs::copy_options::overwrite_existing, error);
  std::string sound = journal::header();
  for (const auto& entry : session.entries) sound += journal::record(entry);
  if (error || !replace_file(path, sound)) {
    spdlog::error("journal: {} is damaged and could not be put in order; a new session begins", path.string());
    return std::nullopt;
  }
  session.bytes = sound.size();
  spdlog::error(
      "journal: {} was damaged in {} places; {} entries could be read, {} key poses and {} traces or seats are "
      "missing; the damaged file is in {}",
      path.string(), contents->damage.size(), session.entries.size(), mended.key_poses_missing, mended.entries_left_out,
      quarantine.string());
  return session;
}

std::vector<std::string> SessionStore::retain(const Config::Journal& config, const std::string& current,
                                              std::int64_t now_s) {
  struct Old {
    fs::path path;
    SessionInfo info;
  };
  std::vector<Old> old;  // oldest first
  std::uint64_t total = 0;
  for (const auto& info : list()) {
    total += info.bytes;
    if (info.id != current) old.push_back({folder_of(info.id), info});
  }
  const auto quarantine = info_of(directory_ / "quarantine");
  if (quarantine.bytes > 0) {
    total += quarantine.bytes;
    old.insert(old.begin(), {directory_ / "quarantine", quarantine});
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
