// SPDX-License-Identifier: Apache-2.0
#include "daemon/append_file.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace kinemap {
namespace {

std::string reason() { return std::generic_category().message(errno); }

}  // namespace

AppendFile::AppendFile(std::string subject, std::filesystem::path path, std::uint64_t length, const Limits& limits)
    : subject_(std::move(subject)), path_(std::move(path)), limits_(limits), bytes_(length) {}

AppendFile::~AppendFile() {
  append({});
  if (fd_ >= 0) ::close(fd_);
}

bool AppendFile::append(std::string_view bytes) {
  const bool taken = bytes.empty() || waiting_.size() <= limits_.max_waiting_bytes;
  gave_up_ = gave_up_ || !taken;
  if (taken) waiting_ += bytes;
  if (waiting_.empty()) return taken;
  auto problem = open();
  if (!problem) problem = write_all();
  report(problem);
  return taken;
}

std::optional<std::string> AppendFile::open() {
  if (fd_ >= 0) return std::nullopt;
  std::error_code ignored;
  std::filesystem::create_directories(path_.parent_path(), ignored);
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) return reason();
  if (::ftruncate(fd_, static_cast<off_t>(bytes_)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0) {
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

std::optional<std::string> AppendFile::write_all() {
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
  bytes_ += done;
  unsynced_ = unsynced_ || done > 0;
  return problem;
}

void AppendFile::sync() {
  if (fd_ < 0 || !unsynced_) return;
  if (::fdatasync(fd_) != 0) return report(reason());
  unsynced_ = false;
}

/// Says so when the disk stops taking the file, and when it takes it again; not with every write in between.
void AppendFile::report(const std::optional<std::string>& problem) {
  if (problem && healthy_)
    spdlog::error("{}: {} cannot be written: {}; mapping goes on in memory, and what waits is written when it can be",
                  subject_, path_.string(), *problem);
  if (!problem && !healthy_)
    spdlog::info("{}: {} is written again, {}", subject_, path_.string(),
                 gave_up_ ? "but more came than could wait: some is missing" : "nothing is missing");
  healthy_ = !problem;
  gave_up_ = gave_up_ && problem;
}

}  // namespace kinemap
