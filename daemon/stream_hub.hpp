// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <vector>

#include "daemon/api.hpp"
#include "daemon/outbox.hpp"

namespace kinemap {

/// What all subscribers are told, each text made once for all of them.
struct News {
  /// The newest message of each topic with a state (map, pose, status); null: none, or nobody asked.
  std::array<SharedText, kTopicCount> newest;
  /// What happened since the last time (topic events).
  std::vector<SharedText> events;
};

/// A client of the stream, as the hub sees it.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  [[nodiscard]] virtual bool wants(Topic topic) const = 0;
  virtual void offer(const News& news, std::chrono::steady_clock::time_point now) = 0;
};

/// Knows the subscribers, makes the news and hands them round; the server's thread only.
class StreamHub {
 public:
  StreamHub(Api& api, double pose_rate_hz) : api_(api), pose_rate_hz_(pose_rate_hz) {}

  /// Forgets it when it is destroyed.
  void join(const std::shared_ptr<Subscriber>& subscriber) { subscribers_.push_back(subscriber); }
  void set_pose_rate(double hz) { pose_rate_hz_ = hz; }

  /// To be called often: makes what is due and offers it.
  void tick(std::chrono::steady_clock::time_point now);
  /// Time between two ticks that the rates ask for.
  [[nodiscard]] std::chrono::milliseconds period() const;

 private:
  using TimePoint = std::chrono::steady_clock::time_point;

  [[nodiscard]] bool wanted(Topic topic) const { return wanted_[static_cast<std::size_t>(topic)]; }
  void update_map();
  void update_pose(TimePoint now);
  void update_status(TimePoint now);
  void take_events();
  SharedText& newest(Topic topic) { return news_.newest[static_cast<std::size_t>(topic)]; }

  Api& api_;
  double pose_rate_hz_;
  std::vector<std::weak_ptr<Subscriber>> subscribers_;
  std::array<bool, kTopicCount> wanted_{};  // by anyone, in this tick
  News news_;
  SharedText map_of_news_;  // the map's text that the news of the topic map wrap
  double pose_time_s_ = -1.0;
  std::uint64_t pose_revision_ = 0;
  TimePoint pose_due_{}, status_due_{};
};

}  // namespace kinemap
