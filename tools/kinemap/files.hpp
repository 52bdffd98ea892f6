// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// The whole file. The Error names the path and why.
Result<std::string> read_file(const std::string& path);

/// A file that becomes `path` as a whole or not at all: it is written beside it and renamed over it in the end.
class NewFile {
 public:
  explicit NewFile(std::string path);
  /// Without a commit nothing is left of it.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// After an error nothing more is written; commit tells of it.
  void append(std::string_view bytes);
  /// Syncs it and renames it over `path`.
  std::optional<Error> commit();

 private:
  void fail();

  std::string path_, temporary_;
  int file_;
  std::optional<Error> error_;
};

/// The same for contents that are there.
std::optional<Error> write_file(const std::string& path, const std::string& contents);

/// Makes the directory (and its parents) where it is missing, and checks that files can be made in it: before hours of
/// work, not after.
std::optional<Error> make_output_directory(const std::string& path);

}  // namespace kinemap::cli
