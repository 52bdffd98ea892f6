// SPDX-License-Identifier: Apache-2.0
#include "core/map.hpp"

#include <iterator>

namespace kinemap {
namespace {
constexpr const char* kNames[] = {"wall", "table", "screen", "chair"};
}

const char* to_string(ObjectType type) { return kNames[static_cast<std::size_t>(type)]; }

std::optional<ObjectType> object_type_from(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kNames); ++i)
    if (name == kNames[i]) return static_cast<ObjectType>(i);
  return std::nullopt;
}

}  // namespace kinemap
