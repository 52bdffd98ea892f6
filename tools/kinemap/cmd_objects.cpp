// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/map_json.hpp"
#include "tools/kinemap/client.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/object_table.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  DaemonOptions daemon;
  std::vector<std::string> types;
  std::string function, near, within, room, sort, limit;
  bool json = false;
};

/// The daemon judges the values: one judge for all its clients.
std::string target_of(const Options& options) {
  std::string types;
  for (const std::string& type : options.types) types += (types.empty() ? "" : ",") + type;
  const std::pair<const char*, const std::string&> params[] = {
      {"type", types},        {"function", options.function}, {"near", options.near},  {"within", options.within},
      {"room", options.room}, {"sort", options.sort},         {"limit", options.limit}};
  std::string query;
  for (const auto& [name, value] : params)
    if (!value.empty()) query += (query.empty() ? "?" : "&") + std::string(name) + "=" + url_encoded(value);
  return "/api/v1/objects" + query;
}

std::vector<double> distances_of(const nlohmann::ordered_json& answer) {
  std::vector<double> distances;
  for (const auto& object : answer["objects"])
    if (object.contains("distance") && object["distance"].is_number())
      distances.push_back(object["distance"].get<double>());
  return distances;
}

int ask(const Options& options) {
  const auto daemon = daemon_of(options.daemon);
  if (!daemon) return fail("objects", daemon.error(), kUsage);
  const std::string target = target_of(options);
  const auto text = http_get(*daemon, target);
  if (!text) return fail("objects", text.error());
  const auto objects = objects_from_text(*text);
  if (!objects) return fail("objects", daemon->text() + target + ": " + objects.error());
  const auto answer = nlohmann::ordered_json::parse(*text);
  if (options.json) return print("objects", pretty_text(answer));
  std::string output = object_table(*objects, distances_of(answer));
  const bool told = answer.contains("matched") && answer["matched"].is_number_unsigned();
  const std::size_t matched = told ? answer["matched"].get<std::size_t>() : objects->size();
  if (objects->size() < matched)
    output += format("%zu of %zu that match\n", objects->size(), matched);
  else
    output += format("%zu object%s\n", matched, matched == 1 ? "" : "s");
  return print("objects", output);
}

}  // namespace

void add_objects(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "objects", "Ask a running kinemapd for objects by type, function and place",
                  "  kinemap objects --function sit --near 1,2           where can one sit, the nearest first\n"
                  "  kinemap objects --type table,screen --room 1 --sort=-size\n"
                  "  kinemap objects --type table --near 1,2 --within 3 --json | jq '.objects[].id'\n"
                  "\nPositions are metres in the map frame.",
                  options, ask);
  add_daemon_options(*command, options->daemon);
  command->add_option("--type", options->types, "One or several with commas: wall, table, screen, chair")
      ->delimiter(',')
      ->type_name("TYPE");
  command
      ->add_option("--function", options->function,
                   "What it is for, one or several with commas: sit, place, view, bound")
      ->type_name("FUNCTION");
  command->add_option("--near", options->near, "The nearest to this point first, with their distances, m")
      ->type_name("X,Y[,Z]");
  command->add_option("--within", options->within, "Not farther from --near than this")->type_name("METRES");
  command->add_option("--room", options->room, "In the room with this id, its walls included")->type_name("ID");
  command
      ->add_option("--sort", options->sort,
                   "id, distance, size, observations, first_seen or last_seen; -size: the largest first")
      ->type_name("KEY");
  command->add_option("--limit", options->limit, "At most so many")->type_name("N");
  command->add_flag("--json", options->json, "Print the daemon's answer as it is");
}

}  // namespace kinemap::cli
