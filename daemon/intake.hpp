// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>

#include "daemon/latest.hpp"
#include "daemon/receiver.hpp"

namespace kinemap {

/// Datagrams to frames: the receiver's Assembler, and what others may know of it. One thread takes; any thread may ask
/// for the state.
class Intake {
 public:
  Intake(const AssemblerConfig& config, SuitSink sink);

  /// One datagram that just arrived.
  void take(std::span<const std::byte> datagram, const std::string& sender);
  /// To be called now and then: tells the sink when the stream has fallen silent.
  void check_silence();
  /// Counts of the sockets, to be changed by the taking thread and then shown with `publish`.
  ReceiverCounts& counts() { return counts_; }
  /// Shows the counts to the other threads; once per batch of datagrams is enough.
  void publish();

  [[nodiscard]] ReceiverState state() const;

 private:
  [[nodiscard]] double now_s() const;
  void update_wearer();
  void update_news(const std::string& sender);

  std::chrono::steady_clock::time_point epoch_ = std::chrono::steady_clock::now();
  SuitSink sink_;
  Assembler assembler_;
  ReceiverCounts counts_;
  bool streaming_ = false;            // frames have come since the sink was told of silence
  ReceiverNews news_;                 // the taking thread's own copy
  std::uint64_t wearer_offered_ = 0;  // revision that the sink has taken
  std::uint64_t wearer_shown_ = 0;    // revision in news_
  LatestValue<ReceiverCounts> shown_counts_;
  Latest<ReceiverNews> shown_news_{std::make_shared<const ReceiverNews>()};
};

}  // namespace kinemap
