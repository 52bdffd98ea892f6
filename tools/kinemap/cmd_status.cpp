// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/kinemap/client.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  DaemonOptions daemon;
  bool json = false;
};

/// Counts are grouped; numbers that are names are not.
std::string value_text(const std::string& key, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_unsigned() && key != "port" && key != "pid") return grouped(value.get<std::uint64_t>());
  if (value.is_number_float()) return format("%.6g", value.get<double>());
  return value.dump();
}

bool is_zero(const Json& value) { return value.is_number() && value.get<double>() == 0.0; }

/// One line for each value, a heading for each group; a group's counters that are zero are gathered on one line.
void append(const Json& group, const std::string& indent, std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::string zeros;
  for (const auto& [key, value] : group.items()) {
    if (value.is_object()) continue;
    if (!indent.empty() && is_zero(value))
      zeros += (zeros.empty() ? "" : ", ") + key;
    else
      rows.push_back({indent + key, value_text(key, value)});
  }
  text += text_table(rows, {0, 1});
  if (!zeros.empty()) text += indent + "0: " + zeros + '\n';
  for (const auto& [key, value] : group.items()) {
    if (!value.is_object()) continue;
    text += indent + key + '\n';
    append(value, indent + "  ", text);
  }
}

/// ": ok: frames come at 120 Hz", in the daemon's words; empty when it gives none.
std::string health_text(const DaemonAddress& daemon) {
  const auto body = http_get(daemon, "/healthz");
  const Json health = body ? Json::parse(*body, nullptr, false) : Json();
  std::string text;
  for (const char* key : {"status", "message"})
    if (health.is_object() && health.contains(key) && health[key].is_string())
      text += ": " + health[key].get<std::string>();
  return text;
}

int status(const Options& options) {
  const auto daemon = daemon_of(options.daemon);
  if (!daemon) return fail("status", daemon.error(), kUsage);
  const auto body = http_get(*daemon, "/api/v1/status");
  if (!body) return fail("status", body.error());
  const Json json = Json::parse(*body, nullptr, false);
  if (!json.is_object()) return fail("status", daemon->text() + ": the answer is not a JSON object; is this kinemapd?");
  if (options.json) return print("status", pretty_text(json));
  std::string text = daemon->text() + health_text(*daemon) + "\n\n";
  append(json, "", text);
  return print("status", text);
}

}  // namespace

void add_status(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "status", "How a running kinemapd is: stream, counters of everything dropped, map",
                  "  kinemap status\n"
                  "  kinemap status --url http://wearable.local:8765 --json\n",
                  options, status);
  add_daemon_options(*command, options->daemon);
  command->add_flag("--json", options->json, "Print the daemon's answer as it is");
}

}  // namespace kinemap::cli
