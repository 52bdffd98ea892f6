// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/map.hpp"
#include "tools/kinemap/truth.hpp"

/// Did each visit end up with the object that was really touched? Judged by times alone, not by where anything is.
namespace kinemap::eval {

/// A visit that hangs on an object of the map most of whose visits were to something else: a wrong loop closure that
/// has survived.
struct WrongVisit {
  std::uint32_t object_id = 0;              ///< in the map
  std::uint32_t owner_id = 0;               ///< what that object mostly is; truth id
  std::optional<std::uint32_t> visited_id;  ///< what was really touched; nothing: a gesture that means nothing
  Visit visit;
};

struct AssociationCheck {
  std::size_t visits = 0;                         ///< of all objects of the map
  std::map<std::uint32_t, std::uint32_t> owners;  ///< map id → id of what most of its visits were to
  std::vector<WrongVisit> wrong;
  std::vector<std::uint32_t> split;      ///< map ids of second objects for one that is there: closures that were missed
  std::vector<std::uint32_t> phantom;    ///< map ids of objects that nobody ever touched
  std::vector<std::uint32_t> misplaced;  ///< map ids that lie where another true object is than the one visited
};

/// The sums of several sessions.
struct AssociationCounts {
  std::size_t visits = 0, wrong = 0, split = 0, phantom = 0, misplaced = 0;
  void add(const AssociationCheck& check);
};

/// `truth_of`: map id → id of the true object that it lies on, where there is one. Nothing is judged where the map or
/// the truth does not give its visits.
AssociationCheck check_association(const std::vector<MapObject>& objects, const std::vector<TruthVisit>& visits,
                                   const std::map<std::uint32_t, std::uint32_t>& truth_of);

}  // namespace kinemap::eval
