// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/association.hpp"

#include <algorithm>

namespace kinemap::eval {
namespace {

/// The true object touched during most of a visit of the map; nullopt when nothing was.
std::optional<std::uint32_t> touched_during(const Visit& visit, const std::vector<TruthVisit>& real) {
  std::optional<std::uint32_t> touched;
  double longest = 0.0;
  for (const TruthVisit& other : real) {
    const double overlap = std::min(visit.end_s, other.end_s) - std::max(visit.begin_s, other.begin_s);
    if (overlap <= longest) continue;
    longest = overlap;
    touched = other.object;
  }
  return touched;
}

/// The true object that most visits were to; of two equal ones that on which the object lies.
std::optional<std::uint32_t> owner_of(const std::vector<std::optional<std::uint32_t>>& touched,
                                      std::optional<std::uint32_t> lies_on) {
  std::map<std::uint32_t, std::size_t> votes;
  for (const auto& id : touched)
    if (id) ++votes[*id];
  std::optional<std::uint32_t> owner;
  for (const auto& [id, count] : votes)
    if (!owner || count > votes[*owner] || (count == votes[*owner] && id == lies_on)) owner = id;
  return owner;
}

}  // namespace

void AssociationCounts::add(const AssociationCheck& check) {
  visits += check.visits;
  wrong += check.wrong.size();
  split += check.split.size();
  phantom += check.phantom.size();
  misplaced += check.misplaced.size();
}

AssociationCheck check_association(const std::vector<MapObject>& objects, const std::vector<TruthVisit>& visits,
                                   const std::map<std::uint32_t, std::uint32_t>& truth_of) {
  AssociationCheck check;
  if (visits.empty()) return check;
  std::map<std::uint32_t, std::uint32_t> owned;  // truth id → the first map object that is it
  for (const MapObject& object : objects) {
    if (object.visits.empty()) continue;
    check.visits += object.visits.size();
    std::vector<std::optional<std::uint32_t>> touched;
    for (const Visit& visit : object.visits) touched.push_back(touched_during(visit, visits));
    const auto at = truth_of.find(object.id);
    const auto lies_on = at == truth_of.end() ? std::nullopt : std::optional(at->second);
    const auto owner = owner_of(touched, lies_on);
    if (!owner) {
      check.phantom.push_back(object.id);
      continue;
    }
    check.owners.emplace(object.id, *owner);
    if (!owned.emplace(*owner, object.id).second) check.split.push_back(object.id);
    if (lies_on && lies_on != owner) check.misplaced.push_back(object.id);
    for (std::size_t i = 0; i < touched.size(); ++i)
      if (touched[i] != owner) check.wrong.push_back({object.id, *owner, touched[i], object.visits[i]});
  }
  return check;
}

}  // namespace kinemap::eval
