// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script.hpp"

#include "tools/sim/activities.hpp"
#include "tools/sim/tracing.hpp"

namespace kinemap::sim {

namespace {

constexpr double kShortest_s = 180.0, kLongest_s = 356.0;
constexpr int kFewRounds = 4;  // more are a long session: as many as asked for, each about as long as the first

/// Something to visit: which list, which index.
struct Stop {
  enum class Kind : std::uint8_t { Wall, Table, Screen, Chair } kind = Kind::Wall;
  std::size_t index = 0;
  int id = 0;
  int room = 0;
  Vec2 place;
};

class Tour {
 public:
  Tour(const SimOptions& options, const Building& building, const Wearer& wearer, Random& random)
      : options_(options), building_(building), random_(random), composer_(options, building, wearer, random) {
    collect();
    ccw_.resize(building.rooms.size());
    next_closure_ = closure_spacing();
    next_distractor_s_ = random_.uniform(20, 45);
  }

  Script run() {
    begin();
    const int rounds = options_.rounds ? *options_.rounds : random_.integer(2, 3);
    std::vector<double> ends;
    for (int round = 0; round < rounds || (composer_.now() < kShortest_s && !options_.rounds); ++round) {
      if (round > 0 && composer_.now() > longest_s_ - 20.0) break;
      go_round(round, rounds);
      ends.push_back(composer_.now());
    }
    composer_.stand(2.0);
    return {std::move(composer_.score()), touched_, ends};
  }

 private:
  void collect() {
    for (std::size_t i = 0; i < building_.walls.size(); ++i) {
      const auto& w = building_.walls[i];
      stops_.push_back({Stop::Kind::Wall, i, w.id, w.room, (w.a + w.b) / 2});
    }
    for (std::size_t i = 0; i < building_.tables.size(); ++i) {
      const auto& t = building_.tables[i];
      stops_.push_back({Stop::Kind::Table, i, t.id, t.room, t.top.centre});
    }
    for (std::size_t i = 0; i < building_.screens.size(); ++i) {
      const auto& s = building_.screens[i];
      stops_.push_back({Stop::Kind::Screen, i, s.id, s.room, s.centre.head<2>()});
    }
    for (std::size_t i = 0; i < building_.chairs.size(); ++i) {
      const auto& c = building_.chairs[i];
      stops_.push_back({Stop::Kind::Chair, i, c.id, c.room, c.seat});
    }
  }

  /// Stands still for the suit to settle, somewhere with room around.
  void begin() {
    // Near a wall, as one comes in: a round begins and ends on its rim.
    Vec2 best = building_.rooms[0].middle();
    for (int i = 0; i < 200; ++i) {
      const Vec2 p = building_.rooms[0].middle() + Vec2(random_.uniform(-4.5, 4.5), random_.uniform(-4.5, 4.5));
      const double c = building_.clearance(p);
      if (!building_.rooms[0].contains(p) || c < 0.5 || c > 0.8) continue;
      best = p;
      break;
    }
    home_ = best;
    composer_.follow_from(best, random_.integer(0, 3) * kPi / 2 + random_.normal(0.1));
    composer_.stand(random_.uniform(2.2, 3.2));
  }

  double closure_spacing() {
    // The paper avoided ways longer than 5–10 m without a loop closure (section VI).
    return options_.closure_spacing_m ? *options_.closure_spacing_m : random_.uniform(5.0, 10.0);
  }

  /// The stops of a room in the order of a way round it, from where the wearer is.
  std::vector<Stop> in_order(int room) {
    std::vector<Stop> stops;
    for (const auto& s : stops_) {
      if (s.room == room) stops.push_back(s);
    }
    const Vec2 middle = building_.rooms[static_cast<std::size_t>(room)].middle();
    const double start = heading_of(composer_.position() - middle),
                 sense = ccw_[static_cast<std::size_t>(room)] ? 1.0 : -1.0;
    const auto key = [&](const Stop& s) {
      const double angle = std::fmod(sense * (heading_of(s.place - middle) - start) + 4 * kPi, 2 * kPi);
      return angle;
    };
    std::stable_sort(stops.begin(), stops.end(), [&](const Stop& a, const Stop& b) { return key(a) < key(b); });
    return stops;
  }

  void go_round(int round, int rounds) {
    // In later rounds as much as time allows; in the first nearly everything.
    const double left_s = longest_s_ - composer_.now(), rounds_left = std::max(1, rounds - round);
    const double share = round == 0 ? 1.0 : std::clamp(left_s / rounds_left / first_round_s_, 0.35, 0.95);
    std::vector<int> rooms;
    for (std::size_t i = 0; i < building_.rooms.size(); ++i) rooms.push_back(static_cast<int>(i));
    if (round % 2 == 1) std::reverse(rooms.begin(), rooms.end());
    this_round_.clear();
    for (const int room : rooms) {
      ccw_[static_cast<std::size_t>(room)] = random_.chance(0.7);
      for (const auto& stop : in_order(room)) {
        if (this_round_.count(stop.id) != 0 && random_.chance(0.8)) continue;  // drawn together with another one
        const bool wall = stop.kind == Stop::Kind::Wall;
        // A wall whose neighbour was never touched has no length that anybody could know.
        const double wanted = round > 0 ? share : wall ? 1.0 : late(room) ? 0.6 : 0.97;
        if (round == 0 && composer_.now() > (wall ? 0.78 : 0.68) * longest_s_) continue;  // time for a second round
        const bool first_seat = stop.kind == Stop::Kind::Chair && !sat_;
        if (composer_.now() > longest_s_ - 32.0 || (!random_.chance(wanted) && !first_seat)) continue;
        if (!may_touch(stop.id)) {
          walk_past(stop);
          continue;
        }
        if (round == 0) close_loop(stop);
        maybe_distract();
        visit(stop, false);
      }
    }
    if (round == 0) first_round_s_ = std::max(30.0, composer_.now());
    if (composer_.now() < longest_s_) composer_.walk_to(home_, std::nullopt);
  }

  /// Whether the first round takes so long that little time would be left for a second one; `room` counts from 0.
  [[nodiscard]] bool late(int room) const {
    return composer_.now() > 0.6 * longest_s_ * (room + 0.7) / static_cast<double>(building_.rooms.size());
  }

  /// Touches the nearest known object again when it is time to.
  void close_loop(const Stop& coming) {
    if (composer_.walked() - last_closure_ < next_closure_ || touched_.size() < 2 || composer_.now() > 0.8 * longest_s_)
      return;
    const Stop* best = nullptr;
    double least = 1e9;
    for (const auto& s : stops_) {
      if (s.id == coming.id || s.id == latest_ || s.room != coming.room || s.kind == Stop::Kind::Chair ||
          touched_.count(s.id) == 0)
        continue;
      const double d = (s.place - composer_.position()).norm() - (s.kind == Stop::Kind::Wall ? 1.0 : 0.0);
      if (d < least) least = d, best = &s;
    }
    if (best == nullptr) return;
    visit(*best, true);
    next_closure_ = closure_spacing();
  }

  /// With a spacing asked for, what is known is touched no sooner.
  [[nodiscard]] bool may_touch(int id) const {
    return !options_.closure_spacing_m || touched_.count(id) == 0 ||
           composer_.walked() - last_closure_ >= next_closure_;
  }
  void walk_past(const Stop& stop) {
    const Vec2 middle = building_.rooms[static_cast<std::size_t>(stop.room)].middle();
    composer_.walk_to(composer_.planner().pushed_clear(stop.place, middle, 0.6), std::nullopt);
  }

  void maybe_distract() {
    if (!options_.distractors || composer_.now() < next_distractor_s_) return;
    distract(composer_);
    next_distractor_s_ = composer_.now() + random_.uniform(30.0, 80.0);
  }

  void visit(const Stop& stop, bool brief) {
    for (const int id : draw(stop, brief)) {
      latest_ = id;
      this_round_.insert(id);
      if (!touched_.insert(id).second) last_closure_ = composer_.walked();
    }
  }

  /// Ids of what was touched or sat on: several when the wearer goes on to the next thing in the same gesture.
  std::vector<int> draw(const Stop& stop, bool brief) {
    const bool goes_on =
        !brief && composer_.now() < longest_s_ - 60.0 && random_.chance(composer_.wearer().habits.chain_chance);
    switch (stop.kind) {
      case Stop::Kind::Wall: {
        const WallFace& wall = building_.walls[stop.index];
        const bool at_right = ccw_[static_cast<std::size_t>(stop.room)] ? random_.chance(0.85) : random_.chance(0.4);
        if (goes_on && may_touch(wall_after(wall).id)) {
          const auto drawn = trace_wall_corner(composer_, wall, wall_after(wall), at_right);
          if (!drawn.empty()) return drawn;
        }
        const bool once = late(stop.room) || options_.closure_spacing_m;  // a second stretch is a known wall
        const auto extent = brief ? WallExtent::Brief : once ? WallExtent::Longest : WallExtent::All;
        return trace_wall(composer_, wall, at_right, extent);
      }
      case Stop::Kind::Table:
        return trace_table(composer_, building_.tables[stop.index]);
      case Stop::Kind::Screen: {
        std::vector<const Screen*> screens{&building_.screens[stop.index]};
        if (const Screen* next = goes_on ? screen_near(*screens[0]) : nullptr) screens.push_back(next);
        return trace_screens(composer_, screens);
      }
      case Stop::Kind::Chair: {
        const Chair& chair = building_.chairs[stop.index];
        if (!sit_on(composer_, chair)) return {};
        sat_ = true;
        return {chair.id};
      }
    }
    return {};
  }

  /// The wall that begins where this one ends.
  [[nodiscard]] const WallFace& wall_after(const WallFace& wall) const {
    return *std::find_if(building_.walls.begin(), building_.walls.end(),
                         [&](const WallFace& w) { return w.room == wall.room && (w.a - wall.b).norm() < 1e-9; });
  }
  /// Another screen, not yet drawn in this round, within some steps.
  [[nodiscard]] const Screen* screen_near(const Screen& screen) const {
    const Screen* best = nullptr;
    double least = 3.0;
    for (const auto& s : building_.screens) {
      const double d = (s.centre - screen.centre).norm();
      if (s.id == screen.id || s.room != screen.room || this_round_.count(s.id) != 0 || d > least || !may_touch(s.id))
        continue;
      least = d, best = &s;
    }
    return best;
  }

  const SimOptions& options_;
  const Building& building_;
  Random& random_;
  const double longest_s_ = options_.rounds.value_or(1) > kFewRounds ? *options_.rounds* kLongest_s : kLongest_s;
  Composer composer_;
  std::vector<Stop> stops_;
  std::vector<bool> ccw_;
  std::set<int> touched_, this_round_;
  Vec2 home_{0, 0};
  bool sat_ = false;
  int latest_ = 0;
  double last_closure_ = 0.0, next_closure_ = 8.0;
  double next_distractor_s_ = 0.0, first_round_s_ = 0.0;
};

/// The body has mass: no jerks on its way over the floor.
void smooth_way(Score& score) {
  smooth_samples(score.ground, 0.12 * score.rate_hz);
  smooth_samples(score.heading, 0.14 * score.rate_hz);
}

}  // namespace

Script write_script(const SimOptions& options, const Building& building, const Wearer& wearer, Random& random) {
  Script script = Tour(options, building, wearer, random).run();
  smooth_way(script.score);
  return script;
}

}  // namespace kinemap::sim
