// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/truth.hpp"

#include <nlohmann/json.hpp>

#include "tools/sim/scene.hpp"

namespace kinemap::sim {

namespace {

using Json = nlohmann::ordered_json;

double rounded(double v) { return std::round(v * 1e6) / 1e6 + 0.0; }
Json array_of(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }
Json array_of(const Quat& q) { return {rounded(q.w()), rounded(q.x()), rounded(q.y()), rounded(q.z())}; }

/// The fields that all objects share, and those of planar ones.
class ObjectWriter {
 public:
  explicit ObjectWriter(const Session& session) : s_(session) {}

  [[nodiscard]] Json wall(const WallFace& w) const {
    const Vec2 middle = (w.a + w.b) / 2;
    Json o = base(w.id, "wall", lift(middle, kRoomHeight / 2), heading_of(w.inward()));
    add_plane(o, lift(w.inward(), 0), lift(middle, kRoomHeight / 2),
              {lift(w.a, 0), lift(w.b, 0), lift(w.b, kRoomHeight), lift(w.a, kRoomHeight)}, w.length(), kRoomHeight);
    o["room"] = w.room;
    return o;
  }
  [[nodiscard]] Json table(const Table& t) const {
    const auto c = t.top.corners();
    Json o = base(t.id, "table", lift(t.top.centre, t.height), t.top.heading);
    add_plane(o, Vec3::UnitZ(), lift(t.top.centre, t.height),
              {lift(c[0], t.height), lift(c[1], t.height), lift(c[2], t.height), lift(c[3], t.height)},
              2 * t.top.half.x(), 2 * t.top.half.y());
    return o;
  }
  [[nodiscard]] Json screen(const Screen& s) const {
    const Vec3 n = lift(direction(s.heading), 0), right = Vec3::UnitZ().cross(n) * s.width / 2,
               up = Vec3::UnitZ() * s.height / 2;
    Json o = base(s.id, "screen", s.centre, s.heading);
    o["class"] = s.big ? "big" : "small";
    add_plane(o, n, s.centre,
              {s.centre - right - up, s.centre + right - up, s.centre + right + up, s.centre - right + up},
              std::max(s.width, s.height), std::min(s.width, s.height));
    return o;
  }
  [[nodiscard]] Json chair(const Chair& c) const { return base(c.id, "chair", lift(c.seat, c.height), c.heading); }

 private:
  [[nodiscard]] Json base(int id, const char* type, const Vec3& centre, double heading) const {
    return {
        {"id", id},
        {"type", type},
        {"pose",
         {{"position", array_of(s_.to_map(centre))}, {"orientation", array_of(about_z(s_.heading_to_map(heading)))}}}};
  }
  void add_plane(Json& o, const Vec3& n, const Vec3& p, const std::array<Vec3, 4>& corners, double first,
                 double second) const {
    const Vec3 n_map = s_.T_map_building().q * n;
    o["plane"] = {{"normal", array_of(n_map)}, {"offset", rounded(n_map.dot(s_.to_map(p)))}};
    Json list = Json::array();
    for (const auto& corner : corners) list.push_back(array_of(s_.to_map(corner)));
    o["corners"] = list;
    o["size"] = {rounded(first), rounded(second)};
  }
  const Session& s_;
};

Json wearer_json(const Session& session) {
  const Wearer& w = session.wearer();
  return {{"stature_m", rounded(w.body.stature)},
          {"touch_m", rounded(-w.p_hand_touch.y())},
          {"palm", w.palm},
          {"touch_point_in_hand_m", array_of(w.p_hand_touch)},
          {"elbow_angle_rad", rounded(w.habits.hip.elbow_angle)}};
}

Json rooms_json(const Session& session) {
  Json rooms = Json::array();
  for (const auto& room : session.building().rooms) {
    Json polygon = Json::array();
    for (const auto& p : room.polygon) {
      const Vec3 q = session.to_map(lift(p, 0));
      polygon.push_back({rounded(q.x()), rounded(q.y())});
    }
    rooms.push_back({{"polygon", polygon}});
  }
  return rooms;
}

Json doorways_json(const Session& session) {
  Json doorways = Json::array();
  for (const auto& door : session.building().doorways) {
    const Vec3 p = session.to_map(lift(door.centre, 0));
    doorways.push_back({{"position", {rounded(p.x()), rounded(p.y())}},
                        {"heading", rounded(session.heading_to_map(door.heading))},
                        {"width", kDoorwayWidth},
                        {"rooms", {door.room_a, door.room_b}}});
  }
  return doorways;
}

Json intervals_json(const Session& session) {
  Json list = Json::array();
  auto intervals = session.script().score.intervals;
  std::stable_sort(intervals.begin(), intervals.end(),
                   [](const Interval& a, const Interval& b) { return a.begin_s < b.begin_s; });
  for (const auto& i : intervals) {
    Json o{{"begin", rounded(i.begin_s)}, {"end", rounded(i.end_s)}, {"label", i.label}};
    if (i.object != 0) o["object"] = i.object;
    if (i.gesture != 0) o["gesture"] = i.gesture;
    if (i.parts > 1) o["part"] = i.part, o["parts"] = i.parts;
    if (i.contact_begin_s >= 0.0) {
      o["contact_begin"] = rounded(i.contact_begin_s);
      o["contact_end"] = rounded(i.contact_end_s);
    }
    for (const auto& [from, to] : i.lift_offs) o["lift_offs"].push_back({rounded(from), rounded(to)});
    list.push_back(o);
  }
  return list;
}

}  // namespace

void TruthWriter::add(const Sample& sample) {
  const auto every = static_cast<std::size_t>(std::max(1.0, std::floor(session_.options().rate_hz / 20.0)));
  if (sample.index % every == 0 || sample.index + 1 == session_.frames())
    trajectory_.push_back({sample.time_s, sample.truth[kPelvis]});
}

Json TruthWriter::json() const {
  const ObjectWriter write(session_);
  Json objects = Json::array(), unvisited = Json::array();
  const auto put = [&](int id, Json object) {
    (session_.script().visited.count(id) ? objects : unvisited).push_back(std::move(object));
  };
  const Building& b = session_.building();
  for (const auto& w : b.walls) put(w.id, write.wall(w));
  for (const auto& t : b.tables) put(t.id, write.table(t));
  for (const auto& s : b.screens) put(s.id, write.screen(s));
  for (const auto& c : b.chairs) put(c.id, write.chair(c));
  Json trajectory = Json::array();
  for (const auto& [t, pose] : trajectory_) {
    trajectory.push_back({rounded(t), rounded(pose.p.x()), rounded(pose.p.y()), rounded(pose.p.z()),
                          rounded(pose.q.w()), rounded(pose.q.x()), rounded(pose.q.y()), rounded(pose.q.z())});
  }
  Json rounds = Json::array();
  for (const double end : session_.script().round_ends_s) rounds.push_back(rounded(end));
  return {{"format", "kinemap/truth"},
          {"version", 1},
          {"seed", session_.options().seed},
          {"drift", to_string(session_.options().drift)},
          {"scene", to_string(session_.building().scene)},
          {"rate_hz", session_.options().rate_hz},
          {"duration_s", rounded(session_.duration_s())},
          {"wearer", wearer_json(session_)},
          {"objects", objects},
          {"unvisited", unvisited},
          {"rooms", rooms_json(session_)},
          {"doorways", doorways_json(session_)},
          {"round_ends", rounds},
          {"intervals", intervals_json(session_)},
          {"trajectory", trajectory}};
}

}  // namespace kinemap::sim
