// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "protocol/assembler.hpp"
#include "protocol/frame_guard.hpp"
#include "protocol/sample_queue.hpp"
#include "protocol/timeline.hpp"

namespace kinemap {

/// What is wrong with a pinned pelvis, and what to change in MVN.
extern const char* const kPinnedMessage;

enum class Shape { Person, NotAPerson, Malformed };
/// The body is the first 23 items; what follows is props and fingers, as the header counts them (all 0 from senders
/// before 2019).
Shape shape_of(const Sample& sample);

/// Turns the ordered samples of one wearer into frames: whole bodies only, with stream time, signs aligned, checked.
/// Counts each sample's datagrams into exactly one of `used`, `not_a_person`, `malformed`, `refused_pinned`,
/// `refused_bones`.
class FrameMaker {
 public:
  explicit FrameMaker(AssemblerStats& stats) : stats_(&stats) {}

  /// Learns the rate from the first samples, before they are taken.
  void prime(std::span<const SampleClock> samples) { timeline_.prime(samples); }
  void take(const Sample& sample, const Assembler::FrameSink& sink);
  /// Takes a frame that has poses, index and a time that never decreases (any origin); it came in so many datagrams.
  void take(SuitFrame frame, std::uint64_t datagrams, const Assembler::FrameSink& sink);
  /// The stream begins anew, from another port or machine; with `other_wearer` nothing known of the body holds any
  /// longer.
  void restart(bool other_wearer);

  [[nodiscard]] double rate_hz() const { return timeline_.rate_hz(); }
  /// The wearer cannot be mapped at present.
  [[nodiscard]] bool pinned() const { return pinned_; }

 private:
  AssemblerStats* stats_;
  Timeline timeline_;
  FrameGuard guard_;
  bool pinned_ = false;
  bool discontinuity_ = false;  ///< of the next frame handed on
  std::optional<double> first_time_s_;
  std::optional<std::uint64_t> last_index_;
  std::uint64_t index_offset_ = 0;
};

}  // namespace kinemap
