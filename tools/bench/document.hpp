// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tools/bench/study.hpp"

namespace kinemap::bench {

/// Writes the document: Markdown in `path`, its pictures as SVG in the directory of the same name beside it ("x.md" →
/// "x/"). notes.json in there may add a hand-written sentence to a worst case, by its name. `command` is what made it.
std::optional<Error> write_document(const std::string& path, const Study& study, const std::string& command);

}  // namespace kinemap::bench
