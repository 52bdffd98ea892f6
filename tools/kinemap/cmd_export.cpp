// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "protocol/export/exports.hpp"
#include "protocol/json_text.hpp"
#include "tools/kinemap/client.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  DaemonOptions daemon;
  std::vector<std::string> names;
  std::string file;
  std::string out;
  bool list = false;
  bool json = false;
};

constexpr const char* kAll = "all";

std::vector<std::string> names_of_all() {
  std::vector<std::string> names;
  for (const Export& file : exports()) names.emplace_back(file.name);
  return names;
}

int list(const Options& options) {
  if (options.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const Export& file : exports())
      json.push_back({{"name", file.name}, {"content_type", file.content_type}, {"description", file.description}});
    return print("export", pretty_text({{"exports", std::move(json)}}));
  }
  std::vector<std::vector<std::string>> rows = {{"name", "what it is"}};
  for (const Export& file : exports()) rows.push_back({file.name, file.description});
  return print("export", text_table(rows, {0, 1}));
}

/// Where the files come from: a daemon, or a map on the disk.
class Source {
 public:
  static Result<Source> open(const Options& options) {
    Source source;
    if (options.file.empty()) {
      auto daemon = daemon_of(options.daemon);
      if (!daemon) return Error{daemon.error()};
      source.daemon_ = *std::move(daemon);
      return source;
    }
    auto map = read_map_files(options.file);
    if (!map) return Error{map.error()};
    source.file_ = options.file;
    source.map_ = *std::move(map);
    return source;
  }

  [[nodiscard]] Result<std::string> bytes(const std::string& name) const {
    if (!map_) return http_get(daemon_, "/api/v1/export/" + name);
    auto made = export_map(*find_export(name), *map_);
    if (!made) return Error{file_ + ": " + made.error()};
    return made;
  }

 private:
  DaemonAddress daemon_;
  std::string file_;
  std::optional<MapSnapshot> map_;
};

/// The path for one file: --out itself, unless that is, or must be, a directory.
fs::path path_of(const Options& options, const std::string& name, std::size_t count) {
  if (options.out.empty()) return name;
  std::error_code code;
  const bool directory = count > 1 || options.out.ends_with('/') || fs::is_directory(options.out, code);
  return directory ? fs::path(options.out) / name : fs::path(options.out);
}

int export_files(const Options& options) {
  if (options.list) return list(options);
  const bool all = std::find(options.names.begin(), options.names.end(), kAll) != options.names.end();
  const std::vector<std::string> names = all ? names_of_all() : options.names;
  if (names.empty()) return fail("export", "give the names of files, or all; 'kinemap export --list' has them", kUsage);
  const bool to_stdout = options.out == "-";
  if (to_stdout && names.size() > 1)
    return fail("export", "--out - takes one file, not " + std::to_string(names.size()), kUsage);
  if (to_stdout && ::isatty(STDOUT_FILENO)) return fail("export", "--out - is a terminal; redirect it", kUsage);

  const auto source = Source::open(options);
  if (!source) return fail("export", source.error(), options.file.empty() ? kUsage : kFailed);
  nlohmann::ordered_json written = nlohmann::ordered_json::array();
  for (const std::string& name : names) {
    const auto bytes = source->bytes(name);
    if (!bytes && all && !options.file.empty()) {
      fail("export", "left out: " + bytes.error());
      continue;
    }
    if (!bytes) return fail("export", bytes.error());
    if (to_stdout) return print("export", *bytes);
    const fs::path path = path_of(options, name, names.size());
    if (path.has_parent_path())
      if (auto error = make_output_directory(path.parent_path().string())) return fail("export", error->message);
    if (auto error = write_file(path.string(), *bytes)) return fail("export", error->message);
    written.push_back({{"name", name}, {"path", path.string()}, {"bytes", bytes->size()}});
  }
  if (options.json) return print("export", pretty_text({{"written", std::move(written)}}));
  std::string text;
  for (const auto& file : written)
    text += format("wrote %s, %s bytes\n", file["path"].get<std::string>().c_str(),
                   grouped(file["bytes"].get<std::size_t>()).c_str());
  return print("export", text);
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "export", "The map as files for other programs: plan, 3-D scene, occupancy grid, world, table, …",
      "  kinemap export plan.svg                               into this directory\n"
      "  kinemap export all --out map --url http://wearable.local:8765\n"
      "  kinemap export floor.pgm floor.yaml --out ~/maps      for ROS: map_server, Nav2\n"
      "  kinemap export scene.glb --file map --out - >scene.glb  of what 'kinemap build' wrote\n"
      "  kinemap export --list\n"
      "\nOf a running session each file is of the newest revision. Each is replaced as a whole. Of a map on the disk,\n"
      "all leaves out what its files do not hold.",
      options, export_files);
  std::vector<std::string> names = names_of_all();
  names.emplace_back(kAll);
  command->add_option("NAME", options->names, "Files, or all")->check(CLI::IsMember(names))->type_name("NAME");
  CLI::Option* url = add_daemon_options(*command, options->daemon);
  command
      ->add_option("--file", options->file,
                   "Instead of a daemon: map.json, or the directory that 'kinemap build' wrote")
      ->excludes(url)
      ->type_name("FILE");
  command
      ->add_option("--out", options->out,
                   "File, or directory (made where missing), or - for standard output; default: here")
      ->type_name("FILE|DIR|-");
  command->add_flag("--list", options->list, "Say what files there are, and end");
  command->add_flag("--json", options->json, "Print what was written as JSON");
}

}  // namespace kinemap::cli
