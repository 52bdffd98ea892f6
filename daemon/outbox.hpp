// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace kinemap {

enum class Topic : std::uint8_t { Map, Pose, Body, Status, Events };
inline constexpr std::size_t kTopicCount = 5;
inline constexpr std::array<const char*, kTopicCount> kTopicNames{"map", "pose", "body", "status", "events"};

/// What one WebSocket client has still to be sent, within a byte budget. Answers are kept, news are replaced by newer
/// news of the same topic (events: the oldest go first), so that a slow client skips to the newest instead of falling
/// ever further behind.
class Outbox {
 public:
  using Text = std::shared_ptr<const std::string>;

  explicit Outbox(std::size_t budget_bytes) : budget_(budget_bytes) {}

  /// An answer to the client's own request. False: the client asks without reading the answers; the connection is to be
  /// closed.
  [[nodiscard]] bool add_answer(Text text);
  struct Added {
    bool added;           ///< false: there is no room now
    std::size_t skipped;  ///< older news that gave way
  };
  /// News, which take the place of older news of the topic.
  Added add_news(Topic topic, Text text);
  /// News of this topic are not wanted any more.
  void forget(Topic topic);
  struct Next {
    Text text;  ///< null: there is none
    bool map = false;
  };
  /// Takes the next message out. Answers come first, then events, then the map before the pose.
  Next next();
  /// Forgets everything.
  void clear();

  /// Bytes that wait.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  bool drop_oldest_event();

  std::size_t budget_;
  std::size_t bytes_ = 0;
  std::deque<Text> answers_;
  std::deque<Text> events_;
  std::array<Text, kTopicCount> newest_;  // one place for each topic; Events uses its own queue
};

}  // namespace kinemap
