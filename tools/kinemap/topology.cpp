// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/topology.hpp"

#include <algorithm>
#include <set>

namespace kinemap::eval {
namespace {

/// The same ring, from its smallest id on and towards the smaller of that one's neighbours.
std::vector<std::uint32_t> canonical(std::vector<std::uint32_t> ring) {
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  if (ring.size() > 2 && ring.back() < ring[1]) std::reverse(ring.begin() + 1, ring.end());
  return ring;
}

std::string list(const std::vector<std::uint32_t>& ids) {
  std::string text;
  for (const std::uint32_t id : ids) text.append(text.empty() ? "" : " ").append(std::to_string(id));
  return text;
}

void check_objects(const Truth& truth, const AssociationCheck& association, TopologyCheck& check) {
  std::set<std::uint32_t> present;
  for (const auto& [map_id, truth_id] : association.owners) present.insert(truth_id);
  const auto say = [&](const std::string& what) { check.wrong.push_back(what); };
  const auto name = [&](std::uint32_t id) {
    const auto object =
        std::find_if(truth.objects.begin(), truth.objects.end(), [id](const auto& o) { return o.id == id; });
    return (object == truth.objects.end() ? "object" : std::string(to_string(object->klass))) + " " +
           std::to_string(id);
  };
  const auto mapped = [](std::uint32_t id) { return "object " + std::to_string(id) + " of the map"; };
  for (const TruthObject& object : truth.objects)
    if (!present.contains(object.id)) say(name(object.id) + " is missing");
  for (const std::uint32_t id : association.split) say(mapped(id) + " is a second " + name(association.owners.at(id)));
  for (const std::uint32_t id : association.phantom) say(mapped(id) + " stands for nothing");
  for (const WrongVisit& visit : association.wrong)
    say(mapped(visit.object_id) + ", " + name(visit.owner_id) + ", has a visit to " +
        (visit.visited_id ? name(*visit.visited_id) : "nothing"));
}

void check_rooms(const MapSnapshot& map, const Truth& truth, const AssociationCheck& association,
                 TopologyCheck& check) {
  std::set<std::vector<std::uint32_t>> rings;
  for (const Room& room : map.rooms) {
    std::vector<std::uint32_t> ring;
    for (const std::uint32_t id : room.wall_ids) {
      const auto owner = association.owners.find(id);
      if (owner != association.owners.end()) ring.push_back(owner->second);
    }
    if (!ring.empty()) rings.insert(canonical(ring));
  }
  for (std::size_t room = 0; room < truth.rooms.size(); ++room) {
    std::vector<std::uint32_t> walls;
    for (const auto& wall : touched_walls(truth, room))
      if (wall) walls.push_back(*wall);
    if (walls.size() < truth.rooms[room].size()) {
      if (walls.size() > 1) rings.erase(canonical(walls));  // more than could be asked for
      continue;
    }
    ++check.rooms;
    if (rings.erase(canonical(walls)))
      ++check.rooms_found;
    else
      check.wrong.push_back("the room of walls " + list(walls) + " is missing");
  }
  for (const auto& ring : rings) check.wrong.push_back("walls " + list(ring) + " make no room");
}

}  // namespace

std::vector<std::optional<std::uint32_t>> touched_walls(const Truth& truth, std::size_t room) {
  const auto& polygon = truth.rooms[room];
  std::vector<std::optional<std::uint32_t>> ids;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d middle = (polygon[i] + polygon[(i + 1) % polygon.size()]) / 2;
    const auto wall = std::find_if(truth.objects.begin(), truth.objects.end(), [&](const TruthObject& object) {
      return object.room == room && (object.pose.p.head<2>() - middle).norm() < 0.01;
    });
    ids.push_back(wall == truth.objects.end() ? std::nullopt : std::optional(wall->id));
  }
  return ids;
}

std::size_t unknown_ends(const Truth& truth, std::uint32_t wall) {
  for (std::size_t room = 0; room < truth.rooms.size(); ++room) {
    const auto ids = touched_walls(truth, room);
    const auto at = std::find(ids.begin(), ids.end(), wall);
    if (at == ids.end()) continue;
    const auto i = static_cast<std::size_t>(at - ids.begin());
    return (ids[(i + 1) % ids.size()] ? 0U : 1U) + (ids[(i + ids.size() - 1) % ids.size()] ? 0U : 1U);
  }
  return 0;
}

TopologyCheck check_topology(const MapSnapshot& map, const Truth& truth, const AssociationCheck& association) {
  TopologyCheck check;
  if (association.visits == 0 && !truth.visits.empty() && !map.objects.empty()) {
    check.wrong.push_back("the map does not say when its objects were visited");
    return check;
  }
  check_objects(truth, association, check);
  check_rooms(map, truth, association, check);
  return check;
}

}  // namespace kinemap::eval
