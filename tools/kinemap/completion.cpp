// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tools/kinemap/option_table.hpp"

namespace kinemap::cli {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

bool names_files(const OptionRow& row) {
  return row.value.find("FILE") != std::string::npos || row.value == "INPUT" || row.value == "TEXT";
}
bool names_directories(const OptionRow& row) { return row.value == "DIR"; }

/// `before` goes before each of the `letters`.
std::string escaped(const std::string& text, const std::string& letters, const std::string& before) {
  std::string result;
  for (const char c : text) result += (letters.find(c) == std::string::npos ? "" : before) + c;
  return result;
}

std::string in_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string bash(const CLI::App& app) {
  std::string names = "--help --version", values, words;
  for (const CLI::App* command : listed_commands(app)) {
    const std::string name = command->get_name();
    names += ' ' + name;
    std::vector<std::string> offers;
    bool files = false;
    for (const OptionRow& row : option_table(*command)) {
      if (row.is_argument()) {
        offers.insert(offers.end(), row.choices.begin(), row.choices.end());
        files = files || row.choices.empty();
        continue;
      }
      offers.insert(offers.end(), row.names.begin(), row.names.end());
      if (row.value.empty()) continue;
      std::string cases;
      for (const std::string& option : row.names) cases += (cases.empty() ? "\"" : " | \"") + name + ' ' + option + '"';
      const std::string reply = !row.choices.empty()     ? "compgen -W '" + joined(row.choices) + "' --"
                                : names_directories(row) ? "compgen -d --"
                                : names_files(row)       ? "compgen -f --"
                                                         : "";
      values += "    " + cases + ")" +
                (reply.empty() ? " return ;;\n" : " mapfile -t COMPREPLY < <(" + reply + " \"$current\"); return ;;\n");
    }
    words += "    " + name + ") words='" + joined(offers) + "'" + (files ? " files=yes" : "") + " ;;\n";
  }
  return "# bash completion for kinemap; made by 'kinemap completion bash'\n"
         "_kinemap() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} command='' words files=no\n"
         "  ((COMP_CWORD > 1)) && command=${COMP_WORDS[1]}\n"
         "  compopt -o filenames 2>/dev/null\n"
         "  case \"$command ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" +
         values + "  esac\n  case $command in\n    '') words='" + names + "' ;;\n" + words +
         "    *) return ;;\n  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
         "  [[ $files == no || $current == -* ]] || mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "
         "\"$current\")\n"
         "}\n"
         "complete -F _kinemap kinemap\n";
}

std::string zsh_action(const OptionRow& row) {
  if (!row.choices.empty()) return "(" + joined(row.choices) + ")";
  return names_directories(row) ? "_files -/" : names_files(row) || row.is_argument() ? "_files" : " ";
}

std::string zsh(const CLI::App& app) {
  std::string commands, cases;
  const auto plain = [](const std::string& text) { return escaped(text, "[]:\\", "\\"); };
  for (const CLI::App* command : listed_commands(app)) {
    commands += "    " + in_quotes(command->get_name() + ":" + plain(command->get_description())) + "\n";
    cases += "    " + command->get_name() + ") _arguments";
    for (const OptionRow& row : option_table(*command)) {
      if (row.is_argument()) {
        cases += " \\\n      " + in_quotes("*:" + row.names.front() + ":" + zsh_action(row));
        continue;
      }
      for (const std::string& name : row.names)
        cases += " \\\n      " + in_quotes(name + "[" + plain(row.description) + "]" +
                                           (row.value.empty() ? "" : ":" + plain(row.value) + ":" + zsh_action(row)));
    }
    cases += " ;;\n";
  }
  return "#compdef kinemap\n# zsh completion for kinemap; made by 'kinemap completion zsh'\n"
         "_kinemap() {\n  local -a commands=(\n" +
         commands +
         "  )\n  if ((CURRENT == 2)); then\n    _describe command commands\n    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n" +
         cases + "  esac\n}\n_kinemap \"$@\"\n";
}

std::string fish(const CLI::App& app) {
  std::string script = "# fish completion for kinemap; made by 'kinemap completion fish'\n";
  for (const CLI::App* command : listed_commands(app)) {
    const std::string name = command->get_name();
    script += "complete -c kinemap -n __fish_use_subcommand -f -a " + name + " -d " +
              in_quotes(escaped(command->get_description(), "\\", "\\")) + "\n";
    for (const OptionRow& row : option_table(*command)) {
      script += "complete -c kinemap -n '__fish_seen_subcommand_from " + name + "'";
      for (const std::string& option : row.names)
        if (!row.is_argument())
          script += option.starts_with("--") ? " -l " + option.substr(2) : " -s " + option.substr(1);
      if (!row.choices.empty())
        script += (row.is_argument() ? " -f -a " : " -x -a ") + in_quotes(joined(row.choices));
      else if (!row.value.empty() && !row.is_argument())
        script += names_files(row) || names_directories(row) ? " -r -F" : " -x";
      script += " -d " + in_quotes(escaped(row.description, "\\", "\\")) + "\n";
    }
  }
  return script;
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  return shell == "bash" ? bash(app) : shell == "zsh" ? zsh(app) : fish(app);
}

}  // namespace kinemap::cli
