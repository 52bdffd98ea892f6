// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/option_table.hpp"

namespace kinemap::cli {

/// Hidden commands: what `cmake --install` puts beside the program is made by the program itself.
void add_shell(CLI::App& app, Run& run) {
  auto shell = std::make_shared<std::string>();
  CLI::App* completion = app.add_subcommand("completion", "Print a completion script")->group("");
  completion->add_option("SHELL", *shell)->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  completion->callback(
      [&app, &run, shell] { run = [&app, shell] { return print("completion", completion_script(app, *shell)); }; });
  app.add_subcommand("man", "Print the manual page")->group("")->callback([&app, &run] {
    run = [&app] { return print("man", manual_page(app, "kinemap " KINEMAP_VERSION)); };
  });
}

}  // namespace kinemap::cli
