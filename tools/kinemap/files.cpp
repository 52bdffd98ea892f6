// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace kinemap::cli {
namespace {

Error errno_error(const std::string& path, const char* what) {
  return {path + ": " + what + ": " + std::strerror(errno)};
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno_error(path, "cannot be opened");
  std::string contents;
  std::array<char, 65536> buffer{};
  ssize_t n = 0;
  while ((n = ::read(file, buffer.data(), buffer.size())) > 0)
    contents.append(buffer.data(), static_cast<std::size_t>(n));
  const bool failed = n < 0;
  const Error error = failed ? errno_error(path, "cannot be read") : Error{};
  ::close(file);
  if (failed) return error;
  return contents;
}

NewFile::NewFile(std::string path)
    : path_(std::move(path)), temporary_(path_ + ".XXXXXX"), file_(::mkostemp(temporary_.data(), O_CLOEXEC)) {
  if (file_ < 0) fail();
}

NewFile::~NewFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_.c_str());
}

void NewFile::fail() {
  if (!error_) error_ = errno_error(path_, "cannot be written");
}

void NewFile::append(std::string_view bytes) {
  while (!bytes.empty() && !error_) {
    const ssize_t n = ::write(file_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return fail();
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::optional<Error> NewFile::commit() {
  if (error_) return error_;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(file_, 0666 & ~mask) != 0 || ::fsync(file_) != 0) fail();
  if (!error_ && ::rename(temporary_.c_str(), path_.c_str()) != 0) error_ = errno_error(path_, "cannot be replaced");
  if (error_) return error_;
  ::close(std::exchange(file_, -1));
  return std::nullopt;
}

std::optional<Error> write_file(const std::string& path, const std::string& contents) {
  NewFile file(path);
  file.append(contents);
  return file.commit();
}

std::optional<Error> make_output_directory(const std::string& path) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code) return Error{path + ": cannot be made: " + code.message()};
  if (!std::filesystem::is_directory(path, code)) return Error{path + ": is not a directory"};
  if (::access(path.c_str(), W_OK | X_OK) != 0) return errno_error(path, "cannot be written to");
  return std::nullopt;
}

}  // namespace kinemap::cli
