// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal_file.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace kinemap {
namespace {

using Clock = std::chrono::steady_clock;

std::string reason() { return std::generic_category().message(errno); }

/// Key poses come by the dozen, each worth a step; all else is announced to others and must be safe before.
bool can_wait(const journal::Entry& entry) {
  return std::holds_alternative<KeyPose>(entry) || std::holds_alternative<journal::StreamMark>(entry);
}

}  // namespace

JournalFile::JournalFile(std::filesystem::path path, std::uint64_t length, const Limits& limits)
    : path_(std::move(path)), limits_(limits), next_sync_(Clock::now()) {
  stats_.bytes = length;
  if (length == 0) waiting_ = journal::header();
}

JournalFile::~JournalFile() {
  write();
  sync();
  if (fd_ >= 0) ::close(fd_);
}

void JournalFile::append(const journal::Entry& entry) {
  ++stats_.entries;
  if (waiting_.size() > limits_.max_waiting_bytes) {
    ++stats_.lost_entries;  // a gap, which mend() closes when it is read
  } else {
    waiting_ += journal::record(entry);
  }
  write();
  if (!can_wait(entry) || Clock::now() >= next_sync_) sync();
}

void JournalFile::write() {
  auto problem = open();
  if (!problem) problem = write_all();
  stats_.waiting_bytes = waiting_.size();
  report(problem);
}

std::optional<std::string> JournalFile::open() {
  if (fd_ >= 0) return std::nullopt;
  std::error_code ignored;
  std::filesystem::create_directories(path_.parent_path(), ignored);
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) return reason();
  if (::ftruncate(fd_, static_cast<off_t>(stats_.bytes)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0) {
    const auto why = reason();
    ::close(fd_);
    fd_ = -1;
    return why;
  }
  // The name of a new file is on the disk only when its folder is.
  const int folder = ::open(path_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return std::nullopt;
}

std::optional<std::string> JournalFile::write_all() {
  struct statvfs disk {};
  if (::fstatvfs(fd_, &disk) == 0 && static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize < limits_.min_free_bytes)
    return "less than journal.min_free_mb is free";
  std::size_t done = 0;
  std::optional<std::string> problem;
  while (done < waiting_.size() && !problem) {
    const ssize_t n = ::write(fd_, waiting_.data() + done, waiting_.size() - done);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (n == 0 || (n < 0 && errno != EINTR)) problem = n == 0 ? "nothing is taken" : reason();
  }
  // What was taken of a record stays; its rest follows when there is room again.
  waiting_.erase(0, done);
  stats_.bytes += done;
  unsynced_ = unsynced_ || done > 0;
  return problem;
}

void JournalFile::sync() {
  if (fd_ < 0 || !unsynced_) return;
  const auto begin = Clock::now();
  if (::fdatasync(fd_) != 0) return report(reason());
  unsynced_ = false;
  next_sync_ = Clock::now() + limits_.sync_every;
  ++stats_.syncs;
  stats_.longest_sync_s = std::max(stats_.longest_sync_s, std::chrono::duration<double>(Clock::now() - begin).count());
}

/// Says so when the disk stops taking the journal, and when it takes it again; not with every entry in between.
void JournalFile::report(const std::optional<std::string>& problem) {
  if (problem && stats_.healthy)
    spdlog::error(
        "journal: {} cannot be written: {}; mapping goes on in memory, and what waits is written when it can be",
        path_.string(), *problem);
  if (!problem && !stats_.healthy) spdlog::info("journal: {} is written again, nothing is missing", path_.string());
  stats_.healthy = !problem;
}

}  // namespace kinemap
