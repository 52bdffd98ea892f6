// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "tools/kinemap/command.hpp"

int main(int argc, char** argv) {
  using namespace kinemap::cli;
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write error that each command reports

  CLI::App app{"Kinemap: a metric map of rooms and furniture from what a person in an Xsens MVN suit does."};
  app.name("kinemap");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("kinemap ") + KINEMAP_VERSION);
  app.footer(
      "\nA first map without a suit:\n"
      "  kinemap sim --seed 1 --out session\n"
      "  kinemap build session/session.pcap --out map\n"
      "  kinemap eval map --truth session/truth.json\n"
      "  kinemap map --file map/map.json --svg plan.svg\n"
      "\n'kinemap COMMAND --help' explains each command. Exit codes: 0 done, 1 bad input or failure, 2 wrong usage or "
      "configuration.");
  Run run;
  for (const auto add : {add_sim, add_replay, add_build, add_map, add_status, add_watch, add_optimize, add_eval}) add(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  return run();
}
