// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace kinemap::cli {
namespace {

Error errno_error(const std::string& path, const char* what) {
  return {path + ": " + what + ": " + std::strerror(errno)};
}

bool write_all(int file, const std::string& contents) {
  std::size_t done = 0;
  while (done < contents.size()) {
    const ssize_t n = ::write(file, contents.data() + done, contents.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Renames a finished temporary file over `path`; removes it when that fails.
std::optional<Error> replace_file(const std::string& temporary, const std::string& path) {
  if (::rename(temporary.c_str(), path.c_str()) == 0) return std::nullopt;
  Error error = errno_error(path, "cannot be replaced");
  ::unlink(temporary.c_str());
  return error;
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

std::optional<Error> write_file(const std::string& path, const std::string& contents) {
  std::string temporary = path + ".XXXXXX";
  const int file = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (file < 0) return errno_error(path, "cannot be written");
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const bool written = write_all(file, contents) && ::fchmod(file, 0666 & ~mask) == 0 && ::fsync(file) == 0;
  std::optional<Error> error;
  if (!written) error = errno_error(path, "cannot be written");
  if (::close(file) != 0 && !error) error = errno_error(path, "cannot be written");
  if (!error) return replace_file(temporary, path);
  ::unlink(temporary.c_str());
  return error;
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
