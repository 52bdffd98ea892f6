// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "protocol/wire/result.hpp"
#include "tools/sim/script.hpp"
#include "tools/sim/suit.hpp"

namespace kinemap::sim {

/// One sample of the session. Both poses are in the map frame: the suit's world at the first frame, where both agree.
struct Sample {
  std::size_t index = 0;  ///< since the first frame, at the suit's rate
  double time_s = 0.0;
  Pose23 truth;
  Pose23 reported;
  Vec3 p_map_touch;  ///< true position of the right hand's touching point, m
};

/// A whole session: building, wearer, what was done, and sample by sample what the suit reports.
class Session {
 public:
  static Result<std::unique_ptr<Session>> create(const SimOptions& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// The next sample; false after the last.
  bool next(Sample& sample);

  [[nodiscard]] std::size_t frames() const { return script_.score.frames(); }
  [[nodiscard]] double duration_s() const { return static_cast<double>(frames()) / options_.rate_hz; }
  [[nodiscard]] const SimOptions& options() const { return options_; }
  [[nodiscard]] const Building& building() const { return building_; }
  [[nodiscard]] const Wearer& wearer() const { return wearer_; }
  [[nodiscard]] const Script& script() const { return script_; }
  [[nodiscard]] const Gait& gait() const { return gait_; }
  [[nodiscard]] const DriftColumn& column() const { return column_; }
  [[nodiscard]] const Body& reported_body() const { return suit_->body(); }
  /// From the building's frame to the map frame.
  [[nodiscard]] const Placed& T_map_building() const { return T_map_building_; }
  [[nodiscard]] Vec3 to_map(const Vec3& p) const { return T_map_building_.p + T_map_building_.q * p; }
  /// And back.
  [[nodiscard]] Vec3 to_building(const Vec3& p) const {
    return T_map_building_.q.conjugate() * (p - T_map_building_.p);
  }
  [[nodiscard]] const std::vector<MagneticPatch>& patches() const { return suit_->patches(); }
  [[nodiscard]] double heading_to_map(double heading) const { return wrapped(heading + map_turn_); }

 private:
  explicit Session(const SimOptions& options);

  SimOptions options_;
  DriftColumn column_;
  Random building_random_, wearer_random_, script_random_, body_random_, suit_random_;
  Wearer wearer_;
  Building building_;
  Script script_;
  Gait gait_;
  std::unique_ptr<Performer> performer_;
  std::unique_ptr<Suit> suit_;
  Placed T_map_building_;
  double map_turn_ = 0.0;
  std::size_t at_ = 0;
};

}  // namespace kinemap::sim
