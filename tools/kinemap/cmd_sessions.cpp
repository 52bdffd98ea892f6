// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "daemon/config.hpp"
#include "daemon/session_files.hpp"
#include "protocol/journal_map.hpp"
#include "protocol/json_text.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/object_table.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/session_folder.hpp"
#include "tools/kinemap/session_summary.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::string action;
  std::vector<std::string> arguments;
  std::string directory;
  std::string config;
  std::string out;
  std::string journal;
  bool json = false;
};

int refuse(const Options& options, const std::string& message, ExitCode code = kFailed) {
  return fail("sessions " + options.action, message, code);
}

/// Why the action cannot go with these arguments.
std::optional<std::string> misuse(const Options& options) {
  const std::string& action = options.action;
  if (action == "list" && !options.arguments.empty()) return "takes no ID; 'kinemap sessions show ID' tells of one";
  if (action == "import" && options.arguments.empty()) return "give the file that was exported with --journal";
  if ((action == "show" || action == "delete") && options.arguments.empty())
    return "give the ID of a session; 'kinemap sessions list' has them";
  if (action == "export" && options.arguments.size() != 1)
    return "give the ID of one session; 'kinemap sessions list' has them";
  if (action == "export" && options.out.empty() && options.journal.empty())
    return "give --out DIR for the map, --journal FILE for the session itself, or both";
  if (action != "export" && (!options.out.empty() || !options.journal.empty()))
    return "--out and --journal are for export";
  return std::nullopt;
}

int list(const Options& options, const SessionFolder& folder) {
  const auto sessions = folder.all();
  if (options.json) {
    Json json = Json::array();
    for (const auto& session : sessions) json.push_back(session_json(session));
    return print("sessions list",
                 pretty_text({{"directory", folder.files().directory().string()}, {"sessions", std::move(json)}}));
  }
  if (sessions.empty()) return print("sessions list", "no sessions in " + folder.files().directory().string() + "\n");
  std::vector<std::vector<std::string>> rows = {{"id", "begin", "duration", "objects", "distance", "size", "state"}};
  for (const auto& session : sessions) rows.push_back(session_row(session));
  return print("sessions list", text_table(rows, {0, 1, 6}));
}

int show(const Options& options, const SessionFolder& folder) {
  Json all = Json::array();
  std::string text;
  for (const std::string& id : options.arguments) {
    const auto session = folder.find(id);
    if (!session) return refuse(options, session.error());
    all.push_back(session_json(*session));
    text += (text.empty() ? "" : "\n") + session_text(*session);
  }
  return print("sessions show", options.json ? pretty_text(all.size() == 1 ? all[0] : all) : text);
}

/// The map of all entries, as `kinemap build` makes one: optimised to the end.
std::shared_ptr<const MapSnapshot> map_of(const std::vector<journal::Entry>& entries, const MapperConfig& config) {
  Mapper mapper(config);
  ProgressBar bar("map");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    journal::tell(mapper, entries[i]);
    bar.update(static_cast<double>(i) / static_cast<double>(entries.size()));
  }
  mapper.finish();
  return mapper.snapshot();
}

int export_session(const Options& options, const SessionFolder& folder, const Config& config) {
  if (!options.out.empty())
    if (auto error = make_output_directory(options.out))
      return refuse(options, error->message + "; choose another --out");
  const auto session = folder.find(options.arguments.front());
  if (!session) return refuse(options, session.error());
  if (!session->readable()) return refuse(options, session->problem);
  const auto& entries = session->read->contents.entries;
  if (session->read->damaged()) refuse(options, "warning: " + damage_text(*session->read));
  Json written = Json::object();
  std::string text;
  if (!options.journal.empty()) {
    const std::string bytes = journal::file_of(entries);
    if (auto error = write_file(options.journal, bytes)) return refuse(options, error->message);
    written["journal"] = options.journal;
    text += "wrote " + options.journal + ", " + size_text(bytes.size()) + "\n";
  }
  if (!options.out.empty()) {
    const auto map = map_of(entries, config.mapper);
    if (auto error = write_map_files(options.out, *map)) return refuse(options, error->message);
    written["out"] = options.out;
    written["objects"] = map->objects.size();
    text = object_table(map->objects) + '\n' + object_counts(*map) + "\nwrote the map to " + options.out + "/\n" + text;
  }
  return print("sessions export", options.json ? pretty_text(written) : text);
}

int remove_sessions(const Options& options, const SessionFolder& folder) {
  Json removed = Json::array();
  std::string text;
  for (const std::string& id : options.arguments) {
    if (auto error = folder.remove(id)) return refuse(options, error->message);
    removed.push_back(id);
    text += "deleted " + id + "\n";
  }
  return print("sessions delete", options.json ? pretty_text({{"deleted", std::move(removed)}}) : text);
}

int import_sessions(const Options& options, const SessionFolder& folder) {
  Json imported = Json::array();
  std::string text;
  for (const std::string& path : options.arguments) {
    auto read = read_journal(path);
    if (!read) return refuse(options, read.error());
    if (read->damaged() || read->contents.torn_bytes > 0)
      refuse(options, "warning: " + path + ": " + damage_text(*read) + "; the rest is imported");
    const auto id = folder.add(read->contents.entries, path);
    if (!id) return refuse(options, id.error());
    imported.push_back(*id);
    text += "imported " + *id + "\n";
  }
  return print("sessions import", options.json ? pretty_text({{"imported", std::move(imported)}}) : text);
}

/// Where the daemon keeps them: --directory, the configuration, systemd's state directory.
std::string directory_of(const Options& options, const Config& config) {
  const char* state = std::getenv("STATE_DIRECTORY");
  return !options.directory.empty()          ? options.directory
         : !config.journal.directory.empty() ? config.journal.directory
         : state != nullptr                  ? state
                                             : "/var/lib/kinemap";
}

int sessions(const Options& options) {
  if (const auto why = misuse(options)) return refuse(options, *why, kUsage);
  Config config;
  if (!options.config.empty()) {
    auto loaded = config_from_file(options.config);
    if (!loaded) return refuse(options, loaded.error(), kUsage);
    config = *std::move(loaded);
  }
  const std::string directory = directory_of(options, config);
  if (options.action == "import")
    if (auto error = make_output_directory((fs::path(directory) / "sessions").string()))
      return refuse(options, error->message);
  if (::access((fs::path(directory) / "sessions").c_str(), R_OK | X_OK) != 0)
    return refuse(options, directory + ": no sessions can be read there: " + std::strerror(errno) +
                               "; --directory says where the daemon keeps them (journal.directory), and those of a "
                               "service need its rights (sudo)");
  const SessionFolder folder(directory);
  if (options.action == "list") return list(options, folder);
  if (options.action == "show") return show(options, folder);
  if (options.action == "export") return export_session(options, folder, config);
  if (options.action == "delete") return remove_sessions(options, folder);
  return import_sessions(options, folder);
}

}  // namespace

void add_sessions(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "sessions", "Sessions on the disk: list, show, export, delete or import them, with or without a daemon",
      "  kinemap sessions list                            id, begin, duration, objects, distance, size, state\n"
      "  kinemap sessions show 20261122T103303Z           one of them, with what is damaged\n"
      "  kinemap sessions export 20261122T103303Z --out map        the map, made anew, as 'kinemap build' writes it\n"
      "  kinemap sessions export 20261122T103303Z --journal s.kjr  the session itself, as one file\n"
      "  kinemap sessions import s.kjr --directory ~/sessions      what was exported so, perhaps elsewhere\n"
      "  kinemap sessions delete 20261122T103303Z\n"
      "  sudo kinemap sessions list                       those of the service\n"
      "\nState: open (a running daemon writes it; it cannot be deleted), closed, quarantined (a damaged journal as it "
      "was\n"
      "found; what can be read of it is the session of the same name), unreadable. With 'record' in the configuration "
      "a\n"
      "session also has the suit's datagrams: 'kinemap build DIRECTORY/sessions/ID --out map'.",
      options, sessions);
  command->add_option("ACTION", options->action, "What to do")
      ->required()
      ->check(CLI::IsMember({"list", "show", "export", "delete", "import"}))
      ->type_name("ACTION");
  command->add_option("ID", options->arguments, "Sessions as list names them; for import: files")->type_name("ID|FILE");
  command
      ->add_option("--directory", options->directory,
                   "Where the daemon keeps them; default: journal.directory of --config, $STATE_DIRECTORY, "
                   "/var/lib/kinemap")
      ->type_name("DIR");
  command
      ->add_option("--config", options->config,
                   "Configuration as for kinemapd: where the sessions are, and for export how maps are made")
      ->type_name("FILE");
  command->add_option("--out", options->out, "For export: directory for the map, made where missing")->type_name("DIR");
  command->add_option("--journal", options->journal, "For export: the session itself as one file, for import")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print as JSON");
}

}  // namespace kinemap::cli
