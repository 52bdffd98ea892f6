// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/assembler.hpp"
#include "protocol/timeline.hpp"
#include "protocol/wire/mxtp.hpp"

namespace kinemap {

/// What other datagrams say of a sample's pose.
struct Extras {
  std::optional<std::array<float, 3>> center_of_mass;      ///< type 24
  std::optional<mxtp::TrackerItem> pelvis, right_forearm;  ///< type 23
};

/// One sample of one character, all its datagrams joined.
struct Sample {
  SampleClock clock;
  mxtp::Header header;                   ///< of the datagram that came first
  std::vector<mxtp::SegmentItem> items;  ///< body, props, left fingers, right fingers
  std::uint64_t datagrams = 0;
  bool restarted = false;  ///< the first one after the counter started anew
  Extras extras;
};

/// Joins the pose datagrams of one sender's character to samples and puts them in order. Holds the first samples back
/// until their rate can be told. Memory is bounded whatever comes in. Counts into the stats given: `waiting`,
/// `duplicates`, `late`, `malformed`, `incomplete…`.
class SampleQueue {
 public:
  using Emit = std::function<void(Sample&&)>;

  SampleQueue(const AssemblerConfig& config, AssemblerStats& stats) : config_(config), stats_(&stats) {}

  void add(const mxtp::Header& header, std::vector<mxtp::SegmentItem> items, double arrival_s, double rate_hz,
           const Emit& emit);
  void add_extras(std::uint32_t counter, const Extras& extras, double arrival_s);
  /// Emits what is due at `now_s`. True once the queue has begun to emit.
  bool drain(double now_s, double rate_hz, const Emit& emit);
  /// Emits whatever is whole, drops the rest.
  void flush(const Emit& emit);
  /// Drops all; `count` gets each sample's items so far and its number of datagrams, which leave `waiting`.
  void discard(const std::function<void(std::size_t items, std::uint64_t datagrams)>& count);

  /// Of the whole samples that wait, in order.
  [[nodiscard]] std::vector<SampleClock> waiting_clocks() const;

 private:
  struct Partial {
    mxtp::Header header;
    double since_s = 0.0;
    std::map<std::uint8_t, std::vector<mxtp::SegmentItem>> parts;  ///< by datagram index
    std::optional<std::uint8_t> last;
    std::size_t items = 0;
    bool restarted = false;
    [[nodiscard]] bool whole() const { return last && parts.size() == *last + 1U; }
  };
  using Waiting = std::map<std::int64_t, Partial>;

  /// The sample's unwrapped index, or nullopt when the datagram was counted away (late, duplicate).
  std::optional<std::int64_t> place(const mxtp::Header& header, double arrival_s, double rate_hz, const Emit& emit);
  [[nodiscard]] bool is_restart(std::int64_t step, double silence_s, double rate_hz) const;
  void begin_anew(std::uint32_t counter, const Emit& emit);
  bool insert(Partial& partial, const mxtp::Header& header, std::vector<mxtp::SegmentItem> items);
  [[nodiscard]] bool overdue(const Waiting::value_type& front, double now_s, double rate_hz) const;
  [[nodiscard]] bool may_start(double now_s) const;
  [[nodiscard]] bool has_extras(const Partial& partial, double now_s) const;
  void emit_front(const Emit& emit);
  void drop_front();

  AssemblerConfig config_;
  AssemblerStats* stats_;
  Waiting waiting_;
  std::size_t waiting_items_ = 0;
  bool started_ = false;
  bool any_ = false;
  std::int64_t newest_index_ = 0;
  std::uint32_t newest_counter_ = 0;
  double newest_arrival_s_ = 0.0;
  bool restart_pending_ = false;
  std::optional<std::int64_t> last_emitted_;
  std::deque<std::pair<std::int64_t, std::uint32_t>> emitted_;  ///< the latest ones: index and time code
  std::deque<std::pair<std::uint32_t, Extras>> extras_;         ///< the latest ones, by counter
  std::optional<double> center_arrival_s_, tracker_arrival_s_;
};

}  // namespace kinemap
