// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/truth.hpp"

namespace kinemap::eval {

const char* to_string(Class c) {
  constexpr const char* kNames[] = {"table", "big screen", "small screen", "wall", "chair"};
  static_assert(std::size(kNames) == kClassCount);
  return kNames[static_cast<std::size_t>(c)];
}

Class class_of(ObjectType type, double long_side_m) {
  switch (type) {
    case ObjectType::Wall:
      return Class::Wall;
    case ObjectType::Table:
      return Class::Table;
    case ObjectType::Chair:
      return Class::Chair;
    case ObjectType::Screen:
      break;
  }
  return long_side_m > kBigScreenM ? Class::BigScreen : Class::SmallScreen;
}

}  // namespace kinemap::eval
