// SPDX-License-Identifier: Apache-2.0
#include "core/map.hpp"

#include <cstddef>

namespace kinemap {
namespace {
constexpr const char* kNames[] = {"wall", "table", "screen", "chair"};
constexpr const char* kEnds[] = {"corner", "inferred", "open"};
constexpr const char* kHandParts[] = {"tips", "palm"};

template <class Enum, std::size_t N>
std::optional<Enum> find(const std::string& name, const char* const (&names)[N]) {
  for (std::size_t i = 0; i < N; ++i)
    if (name == names[i]) return static_cast<Enum>(i);
  return std::nullopt;
}
}  // namespace

const char* to_string(ObjectType type) { return kNames[static_cast<std::size_t>(type)]; }

std::optional<ObjectType> object_type_from(const std::string& name) { return find<ObjectType>(name, kNames); }

const char* to_string(EndKind kind) { return kEnds[static_cast<std::size_t>(kind)]; }

std::optional<EndKind> end_kind_from(const std::string& name) { return find<EndKind>(name, kEnds); }

const char* to_string(HandPart part) { return kHandParts[static_cast<std::size_t>(part)]; }

std::optional<HandPart> hand_part_from(const std::string& name) { return find<HandPart>(name, kHandParts); }

}  // namespace kinemap
