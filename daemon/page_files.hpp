// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace kinemap {

/// One file of the live page, as daemon/web/build.mjs made it. It lies in the program: a wearable has no internet, and
/// the binary may be moved.
struct PageFile {
  std::string_view path;  ///< "/" or "/assets/app-….js"
  const char* content_type;
  std::string_view bytes;
  bool immutable;  ///< the path names the content
};

std::span<const PageFile> page_files();

}  // namespace kinemap
