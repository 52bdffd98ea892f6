// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// The whole file. The Error names the path and why.
Result<std::string> read_file(const std::string& path);

/// Puts `contents` into `path` as a whole or not at all: writes a temporary file beside it, syncs it and renames it
/// over `path`.
std::optional<Error> write_file(const std::string& path, const std::string& contents);

/// Makes the directory (and its parents) where it is missing, and checks that files can be made in it: before hours of
/// work, not after.
std::optional<Error> make_output_directory(const std::string& path);

}  // namespace kinemap::cli
