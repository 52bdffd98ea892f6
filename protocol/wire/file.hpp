// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>

namespace kinemap {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// A C file that closes itself; `release()` it to see whether closing worked.
using File = std::unique_ptr<std::FILE, FileCloser>;

}  // namespace kinemap
