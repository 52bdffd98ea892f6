// SPDX-License-Identifier: Apache-2.0
#include "daemon/export_routes.hpp"

#include <utility>

#include "protocol/gltf.hpp"
#include "protocol/tum.hpp"

namespace kinemap {
namespace {

struct Export {
  const char* name;
  const char* content_type;
  const char* summary;
  std::string (*bytes)(const MapSnapshot& map);
};

constexpr Export kExports[] = {
    {"scene.glb", "model/gltf-binary", "The map as binary glTF 2.0, for any 3-D viewer.", glb_bytes},
    {"trajectory.tum", "text/plain; charset=utf-8", "The optimised key poses, one line each: t x y z qx qy qz qw.",
     optimised_tum},
    {"odometry.tum", "text/plain; charset=utf-8", "The same key poses as the suit gave them.", odometry_tum},
};

}  // namespace

void add_export_routes(Routes& routes, const Sources& sources) {
  for (const Export& item : kExports)
    routes.add({.path = std::string("/api/v1/export/") + item.name,
                .summary = item.summary,
                .content_type = item.content_type,
                .answer = [&sources, item](const Call&) {
                  return Reply{.content_type = item.content_type,
                               .body = std::make_shared<const std::string>(item.bytes(*sources.map())),
                               .download = item.name};
                }});
}

}  // namespace kinemap
