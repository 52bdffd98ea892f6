// SPDX-License-Identifier: Apache-2.0
#include "protocol/export/objects_csv.hpp"

#include <cmath>
#include <numbers>

#include "protocol/rooms.hpp"
#include "protocol/text_format.hpp"

namespace kinemap {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A cell as RFC 4180 wants it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

std::string number(double value, int decimals = 3) {
  const bool is_zero = std::abs(value) < 0.5 * std::pow(10.0, -decimals);  // and not "-0.000"
  return format("%.*f", decimals, is_zero ? 0.0 : value);
}

/// A sigma, where 0 stands for unknown.
std::string sigma(double value, double factor = 1.0, int decimals = 3) {
  return value > 0.0 ? number(factor * value, decimals) : "";
}

void append(std::string& list, const std::string& word) { list += (list.empty() ? "" : "; ") + word; }

/// Where the object faces or, of a table, the long side points.
double heading_deg(const MapObject& object) {
  const bool upright = object.plane && object.type != ObjectType::Table;
  return kDegrees *
         (upright ? std::atan2(object.plane->normal.y(), object.plane->normal.x()) : heading_of(object.pose.q));
}

std::string rooms_of(const MapSnapshot& map, const MapObject& object) {
  std::string rooms;
  for (const Room& room : map.rooms)
    if (is_in_room(object, room)) append(rooms, std::to_string(room.id));
  return rooms;
}

}  // namespace

std::string objects_csv(const MapSnapshot& map) {
  std::string csv =
      "id,type,functions,rooms,x_m,y_m,z_m,heading_deg,length_m,width_or_height_m,height_assumed,open_ended,"
      "sigma_position_m,sigma_heading_deg,sigma_length_m,sigma_width_or_height_m,observations,first_seen_s,"
      "last_seen_s\r\n";
  for (const MapObject& object : map.objects) {
    std::string functions;
    for (const std::string& function : object.functions) append(functions, function);
    const ObjectSigma& s = object.sigma;
    const std::string cells[] = {
        std::to_string(object.id),
        to_string(object.type),
        quoted(functions),
        rooms_of(map, object),
        number(object.pose.p.x()),
        number(object.pose.p.y()),
        number(object.pose.p.z()),
        number(heading_deg(object), 1),
        object.size ? number((*object.size)[0]) : "",
        object.size ? number((*object.size)[1]) : "",
        object.size && object.type == ObjectType::Wall ? (object.height_assumed ? "true" : "false") : "",
        object.ends ? (object.open_ended() ? "true" : "false") : "",
        sigma(s.position_m),
        sigma(s.heading_rad, kDegrees, 1),
        sigma(s.size_m[0]),
        sigma(s.size_m[1]),
        std::to_string(object.observations),
        number(object.first_seen_s),
        number(object.last_seen_s)};
    for (const std::string& cell : cells) csv += (&cell == cells ? "" : ",") + cell;
    csv += "\r\n";
  }
  return csv;
}

}  // namespace kinemap
