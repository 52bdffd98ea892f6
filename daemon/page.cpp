// SPDX-License-Identifier: Apache-2.0
#include "daemon/page.hpp"

#include <algorithm>

#include "daemon/page_files.hpp"

namespace kinemap {
namespace {

Reply page_reply(const std::string& path) {
  const auto files = page_files();
  const auto file = std::find_if(files.begin(), files.end(), [&](const PageFile& f) { return f.path == path; });
  if (file == files.end())
    return error_reply({.status = 404, .code = "not_found", .message = "the page has no file " + path, .nearest = "/"});
  return {.content_type = file->content_type,
          .body = std::make_shared<const std::string>(file->bytes),
          .immutable = file->immutable};
}

}  // namespace

void add_page_routes(Routes& routes) {
  routes.add({.path = "/",
              .summary = "The live page, for browsers.",
              .content_type = "text/html",
              .open = true,
              .answer = [](const Call&) { return page_reply("/"); }});
  routes.add({.path = "/assets/{file}",
              .summary = "What the live page consists of, in files named by their content.",
              .content_type = "application/octet-stream",
              .open = true,
              .answer = [](const Call& call) { return page_reply("/assets/" + std::string(call.id)); }});
  routes.add({.path = "/licenses.txt",
              .summary = "The licences of the libraries in the live page.",
              .content_type = "text/plain",
              .open = true,
              .answer = [](const Call&) { return page_reply("/licenses.txt"); }});
}

}  // namespace kinemap
