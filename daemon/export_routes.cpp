// SPDX-License-Identifier: Apache-2.0
#include "daemon/export_routes.hpp"

#include <atomic>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/export/exports.hpp"

namespace kinemap {
namespace {

constexpr const char* kPath = "/api/v1/export";

/// One file of one map, made once for everyone who asks, by whoever comes first.
class MapFile {
 public:
  MapFile(const Export& file, std::shared_ptr<const MapSnapshot> map) : file_(file), map_(std::move(map)) {}

  [[nodiscard]] bool done() const { return done_; }
  /// Any thread; makes the file when nobody has, or waits for who does.
  Reply reply() {
    std::call_once(once_, [this] {
      auto bytes = export_map(file_, *map_);
      reply_ = bytes ? Reply{.content_type = file_.content_type,
                             .body = std::make_shared<const std::string>(*std::move(bytes)),
                             .download = file_.name}
                     : error_reply({503, "not_in_map", bytes.error()});
      map_ = nullptr;
      done_ = true;
    });
    return reply_;
  }

 private:
  const Export& file_;
  std::shared_ptr<const MapSnapshot> map_;
  std::once_flag once_;
  Reply reply_;
  std::atomic<bool> done_ = false;
};

/// The files of the newest map that were asked for. The server's thread only.
class MapFiles {
 public:
  explicit MapFiles(const Sources& sources) : sources_(sources) {}

  Reply reply(const Export& file) {
    if (auto map = sources_.map(); map != map_) {
      map_ = std::move(map);
      files_.clear();
    }
    auto& slot = files_[&file];
    if (!slot) slot = std::make_shared<MapFile>(file, map_);
    if (slot->done()) return slot->reply();
    return {.content_type = file.content_type, .later = [slot] { return slot->reply(); }};
  }

 private:
  const Sources& sources_;
  std::shared_ptr<const MapSnapshot> map_;  // what files_ are of
  std::map<const Export*, std::shared_ptr<MapFile>> files_;
};

/// {"exports": [{"name", "path", "content_type", "description"}]}
std::string list_text() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Export& file : exports())
    list.push_back({{"name", file.name},
                    {"path", std::string(kPath) + '/' + file.name},
                    {"content_type", file.content_type},
                    {"description", file.description}});
  return nlohmann::ordered_json{{"exports", std::move(list)}}.dump();
}

}  // namespace

void add_export_routes(Routes& routes, const Sources& sources) {
  routes.add({.path = kPath,
              .summary = "The files that the map can be had as.",
              .schema = "exports",
              .answer = [](const Call&) { return reply_of(list_text()); }});
  const auto files = std::make_shared<MapFiles>(sources);
  for (const Export& file : exports())
    routes.add({.path = std::string(kPath) + '/' + file.name,
                .summary = std::string(file.description) + '.',
                .schema = std::string_view(file.content_type) == "application/json" ? "map" : "",
                .content_type = file.content_type,
                .answer = [files, &file](const Call&) { return files->reply(file); }});
}

}  // namespace kinemap
