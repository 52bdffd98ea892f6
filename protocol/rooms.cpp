// SPDX-License-Identifier: Apache-2.0
#include "protocol/rooms.hpp"

#include <algorithm>

#include "core/mapper/polygon.hpp"

namespace kinemap {

bool is_in_room(const MapObject& object, const Room& room) {
  if (object.type == ObjectType::Wall)
    return std::find(room.wall_ids.begin(), room.wall_ids.end(), object.id) != room.wall_ids.end();
  // A screen hangs on the wall, on the room's very edge: what counts is where one stands before it.
  constexpr double kBefore = 0.3;
  Eigen::Vector2d p = object.pose.p.head<2>();
  if (object.plane) p += kBefore * object.plane->normal.head<2>();
  return contains(room.polygon, p);
}

}  // namespace kinemap
