// SPDX-License-Identifier: Apache-2.0
#include "daemon/export_routes.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/export/exports.hpp"

namespace kinemap {
namespace {

constexpr const char* kPath = "/api/v1/export";

/// Files of the newest map, each made when it is first asked for and once for everyone who asks.
class ExportFiles {
 public:
  explicit ExportFiles(const Sources& sources) : sources_(sources) {}

  Reply reply(const Export& file) {
    if (auto map = sources_.map(); map != map_) {
      map_ = std::move(map);
      bodies_.clear();
    }
    SharedText& body = bodies_[&file];
    if (!body) {
      auto bytes = export_map(file, *map_);
      if (!bytes) return error_reply({503, "not_in_map", bytes.error()});
      body = std::make_shared<const std::string>(*std::move(bytes));
    }
    return {.content_type = file.content_type, .body = body, .download = file.name};
  }

 private:
  const Sources& sources_;
  std::shared_ptr<const MapSnapshot> map_;  // what bodies_ are of
  std::map<const Export*, SharedText> bodies_;
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
  const auto files = std::make_shared<ExportFiles>(sources);
  for (const Export& file : exports())
    routes.add({.path = std::string(kPath) + '/' + file.name,
                .summary = std::string(file.description) + '.',
                .schema = std::string_view(file.content_type) == "application/json" ? "map" : "",
                .content_type = file.content_type,
                .answer = [files, &file](const Call&) { return files->reply(file); }});
}

}  // namespace kinemap
