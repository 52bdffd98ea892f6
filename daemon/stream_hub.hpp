// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/api.hpp"
#include "daemon/outbox.hpp"

namespace kinemap {

/// A client of the stream, as the hub sees it.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  /// The fastest rate at which it wants anything, Hz; 0: as it comes.
  [[nodiscard]] virtual double rate_hz() const = 0;
  /// There may be news, which the hub has.
  virtual void offer(std::chrono::steady_clock::time_point now) = 0;
};

/// Knows the subscribers, calls them up when there may be news, and makes each text once for all of them; the server's
/// thread only.
class StreamHub {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  StreamHub(Api& api, double pose_rate_hz) : api_(api), pose_rate_hz_(pose_rate_hz) {}

  /// Forgets it when it is destroyed.
  void join(const std::shared_ptr<Subscriber>& subscriber) { subscribers_.push_back(subscriber); }
  /// Of clients that do not choose one.
  void set_pose_rate(double hz) { pose_rate_hz_ = hz; }
  [[nodiscard]] double pose_rate_hz() const { return pose_rate_hz_; }

  /// To be called every `period()`: looks at what has changed and calls the subscribers up.
  void tick(TimePoint now);
  /// Time between two ticks that the rates ask for.
  [[nodiscard]] std::chrono::milliseconds period() const;

  /// The newest message of a topic with a state (pose, body, status); null: nothing is known yet. The same text as
  /// before as long as nothing has changed.
  SharedText newest(Topic topic);
  /// The map: whole, or what changed since the one that the client has.
  SharedText map_message(const std::optional<KnownMap>& known);
  /// What happened since the tick before (topic events).
  [[nodiscard]] const std::vector<SharedText>& new_events() const { return new_events_; }

 private:
  struct Made {
    SharedText text;
    double time_s = -1.0;        ///< of the frame in it
    std::uint64_t revision = 0;  ///< of the map that corrects it
  };

  void make_pose(Made& made, Answer (*query)(const MapSnapshot&, const LiveBody&, double), Topic topic);
  void take_events();

  Api& api_;
  double pose_rate_hz_;
  double fastest_hz_ = 0.0;
  std::vector<std::weak_ptr<Subscriber>> subscribers_;
  TimePoint now_{}, status_due_{};
  std::array<Made, kTopicCount> made_;
  struct Wrapped {
    SharedText message, of;
  };
  Wrapped whole_map_, delta_map_;  // the ones asked for last
  std::uint64_t events_seen_ = 0;
  std::vector<SharedText> new_events_;
};

}  // namespace kinemap
