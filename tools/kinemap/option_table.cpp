// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/option_table.hpp"

#include <algorithm>
#include <sstream>

namespace kinemap::cli {
namespace {

/// What stands between `open` and `close`, empty where they do not.
std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const auto begin = text.find(open);
  const auto end = text.find(close, begin);
  if (begin == std::string::npos || end == std::string::npos) return "";
  return text.substr(begin + open.size(), end - begin - open.size());
}

/// CLI11 gives a value's type with what it may be: "HOST:PORT", "TEXT:{bash,zsh,fish}", "FLOAT:FLOAT in [0 - 1]".
void read_type(const std::string& type, OptionRow& row) {
  row.value = type.substr(0, std::min(type.find(":{"), type.find(" in [")));
  if (type.find(" in [") != std::string::npos) row.value = row.value.substr(0, row.value.rfind(':'));
  std::istringstream choices(between(type, "{", "}"));
  for (std::string choice; std::getline(choices, choice, ',');) row.choices.push_back(choice);
  row.range = between(type, " in [", "]");
  if (const auto dash = row.range.find(" - "); dash != std::string::npos) row.range.replace(dash, 3, " to ");
}

}  // namespace

std::vector<OptionRow> option_table(const CLI::App& command) {
  std::vector<OptionRow> rows;
  for (const CLI::Option* option : command.get_options()) {
    OptionRow row;
    for (const std::string& name : option->get_snames()) row.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) row.names.push_back("--" + name);
    if (row.names.empty()) row.names.push_back(option->get_name(true));
    if (option->get_type_size_max() != 0) read_type(option->get_type_name(), row);
    row.description = option->get_description();
    row.standard = option->get_default_str();
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<const CLI::App*> listed_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

}  // namespace kinemap::cli
