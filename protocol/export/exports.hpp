// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/map.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// A file that a map becomes, for programs that are not ours. protocol/README.md, "Exports", says what is in it.
struct Export {
  /// What a snapshot must hold beside its objects: one that was read back from files may lack the rest.
  enum class Needs { Objects, Trajectory, StepSigmas };

  const char* name;          ///< of the file: "plan.svg"
  const char* content_type;  ///< of HTTP
  const char* description;   ///< for people, one line
  std::string (*bytes)(const MapSnapshot& map);
  Needs needs = Needs::Objects;
};

/// All there are: what /api/v1/export offers, `kinemap export` fetches and `kinemap build` writes, in the order in
/// which they are written.
std::span<const Export> exports();

/// The one of that name, or null.
const Export* find_export(std::string_view name);

/// The file's bytes: the same for the same map. The Error says what the map lacks.
Result<std::string> export_map(const Export& file, const MapSnapshot& map);

}  // namespace kinemap
