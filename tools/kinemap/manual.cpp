// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "tools/kinemap/option_table.hpp"

namespace kinemap::cli {
namespace {

/// Text as roff takes it: nothing in it is a request or an escape, dashes stay what they are.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
    result += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return result;
}

std::string names_text(const OptionRow& row) {
  std::string text;
  for (const std::string& name : row.names) text += (text.empty() ? "" : ", ") + ("\\fB" + plain(name) + "\\fR");
  return row.value.empty() || row.is_argument() ? text : text + " \\fI" + plain(row.value) + "\\fR";
}

std::string row_text(const OptionRow& row) {
  std::string text = ".TP\n" + names_text(row) + "\n" + plain(row.description);
  std::string choices;
  for (const std::string& choice : row.choices) choices += (choices.empty() ? "" : ", ") + choice;
  const bool told = std::ranges::all_of(
      row.choices, [&](const std::string& choice) { return row.description.find(choice) != std::string::npos; });
  if (!choices.empty() && !told) text += "; one of " + plain(choices);
  if (!row.range.empty()) text += ", " + plain(row.range);
  if (!row.standard.empty()) text += " (default: " + plain(row.standard) + ")";
  return text + ".\n";
}

/// Text whose lines are as they are; what is indented stays so.
std::string as_it_is(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty() || !result.empty()) result += (line.empty() ? "\\&" : plain(line)) + "\n";
  return ".PP\n.nf\n" + result + ".fi\n";
}

std::string command_text(const CLI::App& command) {
  std::string arguments;
  for (const OptionRow& row : option_table(command))
    if (row.is_argument()) arguments += " " + row.names.front();
  std::string text = ".SS \"kinemap " + command.get_name() + plain(arguments) + " [OPTIONS]\"\n" +
                     plain(command.get_description()) + ".\n";
  for (const OptionRow& row : option_table(command))
    if (row.names.back() != "--help") text += row_text(row);  // told once for all
  return text + as_it_is(command.get_footer());
}

constexpr const char* kRest = R"(.SH ENVIRONMENT
.TP
.B KINEMAP_URL
The kinemapd that is asked where no \fB\-\-url\fR is given, as http://HOST:PORT. Without either it is http://127.0.0.1:8765.
.TP
.B KINEMAP_TOKEN
Goes with each request as "Authorization: Bearer", over https or to this machine only.
.TP
.B KINEMAP_FINGERPRINT
SHA\-256 of the certificate that a daemon at https:// must have, as \fBkinemap pair\fR prints it.
.SH EXIT STATUS
.TP
.B 0
Done.
.TP
.B 1
Bad input, or a failure: a file, a daemon that cannot be reached or that refuses.
.TP
.B 2
Wrong usage or configuration.
.SH SEE ALSO
.BR kinemapd (8)
.PP
The formats of all files are specified in protocol/README.md, the API of the daemon in daemon/README.md.
)";

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string text = ".\\\" SPDX-License-Identifier: Apache-2.0\n.\\\" Made by 'kinemap man' from what --help says.\n";
  text += ".TH KINEMAP 1 \"\" \"" + plain(version) +
          "\" \"Kinemap\"\n.SH NAME\nkinemap \\- a metric, functional map of rooms "
          "from what a person in a motion\\-capture suit does\n";
  text +=
      ".SH SYNOPSIS\n.B kinemap\n.I COMMAND\n.RI [ OPTIONS ]\n.SH DESCRIPTION\n" + plain(app.get_description()) + "\n";
  text += as_it_is(app.get_footer());
  for (const OptionRow& row : option_table(app)) text += row_text(row);
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : listed_commands(app)) text += command_text(*command);
  return text + kRest;
}

}  // namespace kinemap::cli
