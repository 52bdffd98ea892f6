// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "daemon/api.hpp"
#include "daemon/foxglove_services.hpp"
#include "protocol/foxglove/scene.hpp"

namespace kinemap::foxglove {

/// The newest message of a channel, the same for all clients.
struct Newest {
  std::uint64_t version = 0;  ///< grows by one with each message; 0: there was none yet
  std::uint64_t time_ns = 0;  ///< stream time
  SharedText text;            ///< null: nobody asked, or there is none
};

/// A client, as the feed sees it.
class Listener {
 public:
  virtual ~Listener() = default;
  [[nodiscard]] virtual bool wants(Channel channel) const = 0;
  /// There may be something new.
  virtual void wake(std::chrono::steady_clock::time_point now) = 0;
};

/// Makes each message once for all clients of the Foxglove protocol. Clients fetch when they can send: no queue can
/// grow, and a slow client skips to the newest. The server's thread only.
class Feed {
 public:
  explicit Feed(Api& api);

  /// Forgets it when it is destroyed.
  void join(const std::shared_ptr<Listener>& listener) { listeners_.push_back(listener); }

  /// To be called often: makes what is due and wakes the clients.
  void tick(std::chrono::steady_clock::time_point now);
  /// Time between two ticks that the rates ask for.
  [[nodiscard]] std::chrono::milliseconds period() const;

  /// Not of the channel Log, which is a sequence.
  [[nodiscard]] const Newest& newest(Channel channel) const { return newest_[static_cast<std::size_t>(channel)]; }
  /// For a client that has the scene of `version`: what changed since, or the whole.
  SharedText scene_since(std::uint64_t version);
  /// The oldest that is kept of the log after `version`; null when there is none.
  [[nodiscard]] const Newest* log_after(std::uint64_t version) const;
  /// Changes whenever the stream time does.
  [[nodiscard]] std::uint64_t time_ns() const { return time_ns_; }

  Services& services() { return services_; }
  /// Of this run of the daemon: clients see by it that everything began anew.
  [[nodiscard]] const std::string& session_id() const { return api_.history().run(); }

 private:
  using TimePoint = std::chrono::steady_clock::time_point;

  bool wanted(Channel channel) const { return wanted_[static_cast<std::size_t>(channel)]; }
  Newest& at(Channel channel) { return newest_[static_cast<std::size_t>(channel)]; }
  void publish(Message message);
  void update_transforms(const MapSnapshot& map, const LiveBody& body, TimePoint now);
  void update_scene(const MapSnapshot& map);
  void update_state(const MapSnapshot& map, TimePoint now);
  void update_log();

  Api& api_;
  Services services_;
  std::vector<std::weak_ptr<Listener>> listeners_;
  std::array<bool, kChannelCount> wanted_{};  // by anyone, in this tick
  std::array<Newest, kChannelCount> newest_;
  std::deque<Newest> log_;
  std::uint64_t time_ns_ = 0;

  Scene scene_;
  bool scene_changed_ = false;  // the newest scene message is what changed since the one before, not the whole
  SharedText whole_scene_;      // of the newest version, once somebody needed it
  // What the newest messages were made of.
  std::uint64_t scene_revision_ = 0, state_revision_ = 0, transforms_revision_ = 0;
  double transforms_time_s_ = -1.0;
  TimePoint transforms_due_{}, state_due_{};
};

}  // namespace kinemap::foxglove
