// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/map_json.hpp"
#include "tools/kinemap/client.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/object_table.hpp"
#include "tools/kinemap/plan_text.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/remote_map.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  DaemonOptions daemon;
  std::string file;
  std::string svg;
  bool json = false;
  bool no_plan = false;
};

constexpr int kMaxColumns = 120;
constexpr int kMaxRows = 40;

std::string describe(const MapSnapshot& map, const Options& options) {
  std::string text;
  if (!options.no_plan && (!map.objects.empty() || map.trajectory.size() > 1))
    text += plan_text(make_plan(map), std::min(terminal_width(STDOUT_FILENO, 100), kMaxColumns), kMaxRows,
                      ::isatty(STDOUT_FILENO) != 0) +
            '\n';
  if (!map.objects.empty()) text += object_table(map.objects) + '\n';
  return text + object_counts(map) + '\n';
}

int show_map(const Options& options) {
  const auto daemon = daemon_of(options.daemon);
  if (!daemon) return fail("map", daemon.error(), kUsage);
  const auto map = options.file.empty() ? fetch_map(*daemon) : read_map_files(options.file);
  if (!map) return fail("map", map.error());

  if (!options.svg.empty()) {
    if (auto error = write_file(options.svg, plan_svg(*map))) return fail("map", error->message);
    std::fprintf(stderr, "wrote %s\n", options.svg.c_str());
  }
  return print("map", options.json ? pretty_text(to_json(*map)) : describe(*map, options));
}

}  // namespace

void add_map(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "map", "The map as a floor plan and a table: of a running kinemapd, or of a file",
                  "  kinemap map                                    of the daemon on this machine\n"
                  "  kinemap map --url http://wearable.local:8765 --svg plan.svg\n"
                  "  kinemap map --file out/map.json --json | jq '.objects[] | select(.type == \"table\")'\n"
                  "\nThe plan is turned so that the walls run level and upright; positions in the table are in the\n"
                  "map frame. The path is drawn where it is known (trajectory.tum beside the file, or the daemon's).",
                  options, show_map);
  CLI::Option* url = add_daemon_options(*command, options->daemon);
  command->add_option("--file", options->file, "map.json, or the directory that 'kinemap build' wrote")
      ->excludes(url)
      ->type_name("FILE");
  command->add_option("--svg", options->svg, "Also draw the plan into an SVG file")->type_name("FILE");
  command->add_flag("--no-plan", options->no_plan, "Leave the drawing out, list only");
  command->add_flag("--json", options->json, "Print the map as JSON instead");
}

}  // namespace kinemap::cli
