// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/commands.hpp"

int main(int argc, char** argv) {
  using namespace kinemap;
  CLI::App app{
      "Kinemap's figures: how accurate, how fast. Nothing here is tested against a limit; it is measured and printed."};
  app.name("bench");
  app.require_subcommand(1);
  cli::Run run;
  for (const auto add : {bench::add_accuracy, bench::add_pipeline, bench::add_server, bench::add_tracker})
    add(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? cli::kOk : cli::kUsage;
  }
  return run();
}
