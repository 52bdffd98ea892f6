// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "tools/kinemap/command.hpp"

int main(int argc, char** argv) {
  using namespace kinemap::cli;
  // A closed pipe and a file that may not grow are write errors, which each command reports.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);

  CLI::App app{"Kinemap: a metric map of rooms and furniture from what a person in an Xsens MVN suit does."};
  app.name("kinemap");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("kinemap ") + KINEMAP_VERSION);
  app.footer(
      "\nA first map without a suit:\n"
      "  kinemap sim --seed 1 --out session\n"
      "  kinemap build session/session.pcap --out map\n"
      "  kinemap eval map --truth session/truth.json\n"
      "  kinemap map --file map\n"
      "\n'kinemap COMMAND --help' explains each command. Exit codes: 0 done, 1 bad input or failure, 2 wrong usage or "
      "configuration.");
  Run run;
  for (const auto add : {add_sim, add_replay, add_build, add_map, add_objects, add_export, add_status, add_doctor,
                         add_watch, add_sessions, add_optimize, add_eval, add_pair, add_shell})
    add(app, run);
  const auto is_asked = [&](const CLI::App* command) { return command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_asked).empty())
    return fail(argv[1], "there is no such command; 'kinemap --help' lists them", kUsage);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  return run();
}
