// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/map.hpp"
#include "daemon/answer.hpp"
#include "daemon/pipeline.hpp"

namespace kinemap {

/// Something happened, for those who listen.
struct LiveEvent {
  std::uint64_t number = 0;  ///< counts from 1
  std::string kind;          ///< "gesture_began", "trace", "sitting", "object_found", …: protocol/README.md has all
  double time_s = 0.0;       ///< stream time
  std::string message;       ///< for people
  SharedText data;           ///< JSON of the whole event
};

/// What happens, in its order: told by the pipeline (notices), or seen by comparing the state now with the one before.
/// Keeps the newest kKept.
class LiveEvents {
 public:
  static constexpr std::size_t kKept = 1000;

  /// What is looked at; to be called often.
  struct State {
    std::shared_ptr<const MapSnapshot> map;
    double time_s = 0.0;     ///< stream time of the newest frame
    bool tracing = false;    ///< the modelling gesture is held
    bool receiving = false;  ///< frames of the suit come
  };
  void look(const State& state);
  void add(const Notice& notice);

  [[nodiscard]] const std::deque<LiveEvent>& all() const { return events_; }
  /// Of the newest event; 0 before the first.
  [[nodiscard]] std::uint64_t newest() const { return count_; }

 private:
  struct Seen {
    ObjectType type;
    Eigen::Vector3d p;
    std::optional<std::array<double, 2>> size;
    int observations;
  };

  void compare_maps(const MapSnapshot& map, double time_s);
  void compare_closures(const MapSnapshot& map, const std::vector<std::uint32_t>& seen_again, double time_s);

  std::deque<LiveEvent> events_;
  std::uint64_t count_ = 0;
  std::shared_ptr<const MapSnapshot> map_;  // of the look before
  std::map<std::uint32_t, Seen> announced_;
  bool tracing_ = false;
  bool receiving_ = false;
};

}  // namespace kinemap
