// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/session.hpp"

#include "tools/sim/scene.hpp"

namespace kinemap::sim {

namespace {

Wearer make_wearer(const SimOptions& options, const DriftColumn& column, Random& random) {
  Wearer w;
  const double stature = options.stature_m ? *options.stature_m : random.uniform(1.55, 1.95);
  w.body = make_body(stature, random);
  w.palm = random.chance(0.25);
  const double along = w.palm ? 0.052 * stature + random.bounded_normal(column.touch_spread_m / 2, 2.5)
                              : 0.105 * stature + random.bounded_normal(column.touch_spread_m, 2.5);
  const double thick = (w.palm ? 0.022 : 0.008) + std::abs(random.bounded_normal(column.thickness_spread_m, 2.5));
  w.p_hand_touch = Vec3(0.0, -along, -thick);
  w.walk_speed = random.uniform(0.9, 1.2);
  w.trace_speed = random.uniform(0.24, 0.34);
  w.sloppiness = options.sloppiness;
  w.habits = draw_habits(options.sloppiness, random);
  return w;
}

/// For whom the building is furnished, whoever comes.
Wearer usual_wearer(const SimOptions& options, const DriftColumn& column) {
  Random random(options.seed, 2);
  return make_wearer(options, column, random);
}

Reach reach_of(const Wearer& w) {
  const double h = w.body.stature;
  return {(w.palm ? 1.0 : 1.07) * h, 0.26 * h - (w.palm ? 0.09 : 0.0)};
}

}  // namespace

std::optional<std::string> check(const SimOptions& o) {
  const auto outside = [](double v, double low, double high) { return !(v >= low && v <= high); };
  if (o.rooms && outside(*o.rooms, 1, 3)) return "rooms must be 1, 2 or 3";
  if (o.rounds && outside(*o.rounds, 1, 500)) return "rounds must be 1–500";
  if (outside(o.rate_hz, 20, 500)) return "rate must be 20–500 Hz (MVN: 60, 100, 120, 240)";
  if (o.stature_m && outside(*o.stature_m, 1.4, 2.1)) return "stature must be 1.4–2.1 m";
  if (outside(o.speed, 0.5, 2.0)) return "speed must be 0.5–2";
  if (o.closure_spacing_m && outside(*o.closure_spacing_m, 1, 100)) return "closure-spacing must be 1–100 m";
  if (outside(o.sloppiness, 0, 1)) return "sloppiness must be 0–1";
  if (o.packet_loss && outside(*o.packet_loss, 0, 0.9)) return "packet loss must be 0–0.9";
  if (o.room_size && (outside((*o.room_size)[0], 3, 9) || outside((*o.room_size)[1], 3, 9)))
    return "room size must be 3–9 m each way";
  return check_scene(o);
}

std::optional<Severity> severity_from(const std::string& name) {
  if (name == "good") return Severity::Good;
  if (name == "default") return Severity::Default;
  if (name == "bad") return Severity::Bad;
  return std::nullopt;
}

const char* to_string(Severity severity) {
  return severity == Severity::Good ? "good" : severity == Severity::Bad ? "bad" : "default";
}

Result<std::unique_ptr<Session>> Session::create(const SimOptions& options) {
  if (const auto wrong = check(options)) return Error{*wrong};
  return std::unique_ptr<Session>(new Session(options));
}

Session::Session(const SimOptions& options)
    : options_(options),
      column_(column_of(options.drift)),
      building_random_(options.seed, 1),
      wearer_random_(options.wearer_seed.value_or(options.seed), 2),
      script_random_(options.seed, 3),
      body_random_(options.seed, 4),
      suit_random_(options.seed, 5),
      wearer_(make_wearer(options, column_, wearer_random_)),
      building_(make_building(options, reach_of(usual_wearer(options, column_)), building_random_)),
      script_(write_script(options, building_, wearer_, script_random_)),
      gait_(make_gait(script_.score, wearer_.body)) {
  performer_ = std::make_unique<Performer>(script_.score, gait_, wearer_, body_random_);
  suit_ = std::make_unique<Suit>(wearer_, script_.score, gait_, *performer_, building_, column_, options_.hold_feet,
                                 suit_random_);
  // MVN's world: near where the wearer was calibrated, x about forward.
  const Pose23 first = performer_->pose(0);
  map_turn_ = body_random_.normal(0.05) - heading_of(Vec2((first[kPelvis].q * Vec3::UnitX()).head<2>()));
  T_map_building_.q = about_z(map_turn_);
  const Vec3 start = T_map_building_.q * first[kPelvis].p;
  T_map_building_.p = Vec3(body_random_.normal(0.05) - start.x(), body_random_.normal(0.05) - start.y(), 0.0);
}

bool Session::next(Sample& sample) {
  if (at_ >= frames()) return false;
  sample.index = at_;
  sample.time_s = static_cast<double>(at_) / options_.rate_hz;
  sample.truth = performer_->pose(at_);
  sample.reported = suit_->report(at_, sample.truth);
  for (Pose23* pose : {&sample.truth, &sample.reported}) {
    for (auto& segment : *pose) {
      segment.p = to_map(segment.p);
      segment.q = (T_map_building_.q * segment.q).normalized();
    }
  }
  sample.p_map_touch = sample.truth[kRightHand].p + sample.truth[kRightHand].q * wearer_.p_hand_touch;
  ++at_;
  return true;
}

}  // namespace kinemap::sim
