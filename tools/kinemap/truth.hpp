// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "protocol/tum.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap::eval {

/// The classes of the paper's Table I, and chairs.
enum class Class : std::uint8_t { Table, BigScreen, SmallScreen, Wall, Chair };
inline constexpr std::size_t kClassCount = 5;
const char* to_string(Class c);  ///< "table", "big screen", …

/// Longest side from which a screen counts as big, where the truth does not say.
inline constexpr double kBigScreenM = 1.0;
Class class_of(ObjectType type, double long_side_m);

/// One real object, in the frame of the true trajectory (z up, m).
struct TruthObject {
  std::uint32_t id = 0;
  ObjectType type = ObjectType::Wall;
  Class klass = Class::Wall;
  Pose pose;  ///< centre; +x: a wall's or screen's normal, where a chair's sitter faces, a table's long side
  std::array<double, 2> size{};     ///< [long, short], walls [length, height], m; zero for chairs
  std::optional<std::size_t> room;  ///< walls: which of Truth::rooms it bounds, where the truth says
};

/// A time in which the wearer really touched or sat on one of the objects, s.
struct TruthVisit {
  std::uint32_t object = 0;  ///< its id
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// What `kinemap sim` says of a session.
struct Truth {
  std::vector<TruthObject> objects;                 ///< those that the wearer touched or sat on
  std::vector<TruthObject> untouched;               ///< others: nobody can find them
  std::vector<std::vector<Eigen::Vector2d>> rooms;  ///< corners, one wall from each to the next
  std::vector<TimedPose> trajectory;                ///< true pelvis, by ascending time (s since the first frame)
  std::vector<TruthVisit> visits;                   ///< empty: not known
  std::size_t distractors = 0;                      ///< gestures and postures that mean nothing
};

/// Reads a truth.json. The Error names the key path.
Result<Truth> truth_from_text(const std::string& text);

}  // namespace kinemap::eval
