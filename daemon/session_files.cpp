// SPDX-License-Identifier: Apache-2.0
#include "daemon/session_files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

namespace kinemap {
namespace {

namespace fs = std::filesystem;

constexpr int kTries = 20;
constexpr std::chrono::milliseconds kBetweenTries{50};

void add_file(const fs::path& path, SessionInfo& info) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return;
  info.bytes += static_cast<std::uint64_t>(file.st_size);
  info.changed_s = std::max<std::int64_t>(info.changed_s, file.st_mtime);
}

/// `each(entry)` for what is in a folder; names that begin with a dot are being made.
template <class Each>
void for_each_in(const fs::path& directory, Each each) {
  std::error_code error;
  for (auto it = fs::directory_iterator(directory, error); !error && it != fs::end(it); it.increment(error))
    if (!it->path().filename().string().starts_with('.')) each(*it);
}

void sort_by_id(std::vector<SessionInfo>& list) {
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
}

}  // namespace

std::vector<SessionInfo> SessionFiles::sessions() const {
  std::vector<SessionInfo> list;
  for_each_in(directory_ / "sessions", [&](const fs::directory_entry& folder) {
    std::error_code error;
    if (!folder.is_directory(error)) return;
    SessionInfo info{folder.path().filename().string()};
    for_each_in(folder.path(), [&](const fs::directory_entry& file) { add_file(file.path(), info); });
    list.push_back(std::move(info));
  });
  sort_by_id(list);
  return list;
}

std::vector<SessionInfo> SessionFiles::quarantines() const {
  std::vector<SessionInfo> list;
  for_each_in(quarantine(), [&](const fs::directory_entry& file) {
    if (file.path().extension() != ".kjr") return;
    SessionInfo info{file.path().stem().string()};
    add_file(file.path(), info);
    list.push_back(std::move(info));
  });
  sort_by_id(list);
  return list;
}

std::uint64_t SessionFiles::bytes() const {
  std::uint64_t sum = 0;
  for (const auto& info : sessions()) sum += info.bytes;
  for (const auto& info : quarantines()) sum += info.bytes;
  return sum;
}

std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for_each_in(folder, [&](const fs::directory_entry& file) {
    if (file.path().extension() == ".pcap") paths.push_back(file.path());
  });
  std::sort(paths.begin(), paths.end());
  return paths;
}

Result<std::optional<SessionLock>> SessionLock::take(const fs::path& directory) {
  const int file = ::open((directory / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return Error{directory.string() + " cannot be written: " + std::generic_category().message(errno)};
  for (int i = 0; ::flock(file, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (i == kTries) {
      ::close(file);
      return std::optional<SessionLock>();
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
  return std::optional<SessionLock>(SessionLock(file));
}

SessionLock::SessionLock(SessionLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

SessionLock::~SessionLock() {
  if (file_ >= 0) ::close(file_);
}

void SessionLock::name(const std::string& id) const {
  const std::string line = id + '\n';
  // In place and of about the same length: a full disk does not mind. What it refuses costs a name, not a session.
  if (::pwrite(file_, line.data(), line.size(), 0) == static_cast<ssize_t>(line.size()) &&
      ::ftruncate(file_, static_cast<off_t>(line.size())) == 0)
    ::fdatasync(file_);
}

std::string SessionLock::named(const fs::path& directory) {
  std::ifstream in(directory / "lock");
  std::string id;
  std::getline(in, id);
  return id;
}

bool SessionLock::held(const fs::path& directory) {
  const int file = ::open((directory / "lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool taken = ::flock(file, LOCK_SH | LOCK_NB) != 0;
  ::close(file);
  return taken;
}

Result<ReadJournal> read_journal(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
    return Error{path.string() + ": cannot be read" + (fs::exists(path) ? "" : ": there is no such file")};
  auto contents = journal::read(text.view(), path.string());
  if (!contents) return Error{contents.error()};
  ReadJournal read{*std::move(contents), {}};
  read.mended = journal::mend(read.contents.entries);
  return read;
}

}  // namespace kinemap
