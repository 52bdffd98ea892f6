// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace kinemap::cli {

/// One option or argument of a command as shells and manuals tell of it, read from CLI11, so that none can be missing.
struct OptionRow {
  std::vector<std::string> names;  ///< "-h", "--help"; of an argument: one without dashes
  std::string value;               ///< "FILE"; empty: a flag
  std::vector<std::string> choices;
  std::string range;  ///< "0 to 1"; empty: not bounded
  std::string description;
  std::string standard;  ///< its default, when that is told
  [[nodiscard]] bool is_argument() const { return !names.front().starts_with('-'); }
};

std::vector<OptionRow> option_table(const CLI::App& command);

/// The commands that --help lists.
std::vector<const CLI::App*> listed_commands(const CLI::App& app);

/// A script that completes the commands, options and values of `app` in "bash", "zsh" or "fish".
std::string completion_script(const CLI::App& app, const std::string& shell);

/// The manual page of `app` and all its commands, section 1, in roff's man macros.
std::string manual_page(const CLI::App& app, const std::string& version);

}  // namespace kinemap::cli
