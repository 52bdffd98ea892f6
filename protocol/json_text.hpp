// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace kinemap {

/// JSON for files and terminals: two-space indent, a final newline, and an array of plain values (a point, a size) on
/// one line, where it can be read. Keys keep their order; the same value gives the same bytes. Text that is not UTF-8
/// is replaced, never thrown at.
std::string pretty_text(const nlohmann::ordered_json& json);

/// The same for the network: no white space.
std::string compact_text(const nlohmann::ordered_json& json);

}  // namespace kinemap
