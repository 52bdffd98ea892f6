// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/session_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "tools/kinemap/files.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;
constexpr const char* kQuarantine = "quarantine/";

/// What is made in a service's directory belongs to the service, even when an administrator made it.
void give_to_owner_of(const fs::path& directory, const fs::path& made) {
  struct stat owner {};
  if (::stat(directory.c_str(), &owner) != 0 || ::geteuid() != 0) return;
  for (const auto& path : {made, made / "journal.kjr"})
    if (::lchown(path.c_str(), owner.st_uid, owner.st_gid) != 0) return;
}

const journal::SessionStart* start_of(const std::vector<journal::Entry>& entries) {
  for (const auto& entry : entries)
    if (const auto* start = std::get_if<journal::SessionStart>(&entry)) return start;
  return nullptr;
}

/// Nothing in it leads out of the folder.
bool is_name(const std::string& id) {
  return !id.empty() && id.size() < 64 &&
         std::all_of(id.begin(), id.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
}

}  // namespace

StoredSession SessionFolder::read(const SessionInfo& info, bool quarantined) const {
  StoredSession session;
  session.id = (quarantined ? kQuarantine : "") + info.id;
  session.bytes = info.bytes;
  const auto path = quarantined ? files_.quarantined(info.id) : files_.journal_of(info.id);
  session.path = path.string();
  const bool open =
      !quarantined && SessionLock::named(files_.directory()) == info.id && SessionLock::held(files_.directory());
  if (!quarantined)
    for (const auto& recording : recordings_in(files_.folder_of(info.id)))
      session.recordings.push_back(recording.string());
  auto read = read_journal(path);
  session.state = quarantined ? StoredSession::State::Quarantined
                  : open      ? StoredSession::State::Open
                  : read      ? StoredSession::State::Closed
                              : StoredSession::State::Unreadable;
  if (!read) {
    session.problem = read.error();
    return session;
  }
  session.summary = summary_of(read->contents.entries);
  session.read = *std::move(read);
  return session;
}

std::vector<StoredSession> SessionFolder::all() const {
  std::vector<StoredSession> list;
  for (const bool quarantined : {false, true})
    for (const auto& info : quarantined ? files_.quarantines() : files_.sessions()) {
      list.push_back(read(info, quarantined));
      if (list.back().read) list.back().read->contents.entries = {};  // hundreds of sessions may be there
    }
  return list;
}

Result<StoredSession> SessionFolder::find(const std::string& id) const {
  const bool quarantined = id.starts_with(kQuarantine);
  const std::string name = quarantined ? id.substr(std::string(kQuarantine).size()) : id;
  for (const auto& info : quarantined ? files_.quarantines() : files_.sessions())
    if (info.id == name) return read(info, quarantined);
  return Error{"there is no session " + id + " in " + files_.directory().string() +
               "; 'kinemap sessions list' has those that there are"};
}

std::optional<Error> SessionFolder::remove(const std::string& id) const {
  auto lock = SessionLock::take(files_.directory());  // no daemon begins meanwhile
  if (!lock) return Error{lock.error()};
  if (!*lock && SessionLock::named(files_.directory()) == id)
    return Error{id + " is written by a running kinemapd; end that first, or wait until it begins another session"};
  const auto session = find(id);
  if (!session) return Error{session.error()};
  const fs::path path = session->path;
  std::error_code error;
  fs::remove_all(session->state == StoredSession::State::Quarantined ? path : path.parent_path(), error);
  if (error) return Error{id + ": cannot be deleted: " + error.message()};
  return std::nullopt;
}

Result<std::string> SessionFolder::add(const std::vector<journal::Entry>& entries, const std::string& path) const {
  const auto* start = start_of(entries);
  if (start == nullptr) return Error{path + ": its first entry, which names the session, is lost"};
  const std::string id = start->id;
  if (!is_name(id)) return Error{path + ": \"" + id + "\" is no name of a session; letters and digits are expected"};
  const auto folder = files_.folder_of(id);
  std::error_code error;
  if (fs::exists(folder, error))
    return Error{path + ": session " + id + " is in " + files_.directory().string() +
                 " already; delete that one first, or use another --directory"};
  // Made aside and moved as a whole: a daemon that starts meanwhile sees all of it or nothing.
  const auto aside = files_.directory() / "sessions" / ("." + id);
  if (auto failed = make_output_directory(aside.string())) return *failed;
  if (auto failed = write_file((aside / "journal.kjr").string(), journal::file_of(entries))) return *failed;
  give_to_owner_of(files_.directory() / "sessions", aside);
  fs::rename(aside, folder, error);
  if (error) return Error{folder.string() + ": cannot be made: " + error.message()};
  return id;
}

}  // namespace kinemap::cli
