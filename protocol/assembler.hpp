// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/body.hpp"
#include "protocol/wire/mxtp.hpp"

namespace kinemap {

struct AssemblerConfig {
  int character = -1;  ///< which character is mapped; −1: the first that streams a whole body
  double reorder_window_s =
      0.05;  ///< a sample waits so long (stream or arrival time) for missing datagrams and for older samples
  double restart_silence_s = 0.75;  ///< a counter that jumps back counts as a restart after this much silence
};

/// What became of the datagrams. Each one is in exactly one of the counters marked (d), so that their sum,
/// `accounted()`, is `datagrams` at any time; the others count samples or events.
struct AssemblerStats {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;
  std::array<std::uint64_t, mxtp::kFaultCount> faults{};  ///< (d) refused by the decoder
  std::uint64_t used = 0;                                 ///< (d) in frames handed on
  std::uint64_t waiting = 0;                              ///< (d) in samples that are not whole or not due yet
  std::uint64_t skipped_types = 0;                        ///< (d) known types that are not used; type 01 beside type 02
  std::uint64_t meta = 0;                                 ///< (d) types 12, 13, 23, 24, 25 used
  std::uint64_t duplicates = 0;                           ///< (d)
  std::uint64_t late =
      0;  ///< (d) came after a newer sample had been handed on, or with a counter far off without silence
  std::uint64_t incomplete_datagrams = 0;  ///< (d) of incomplete samples
  std::uint64_t malformed = 0;  ///< (d) of samples whose datagrams contradict each other or whose items are no body
  std::uint64_t other_character = 0;  ///< (d) another wearer
  std::uint64_t other_sender = 0;     ///< (d) the same character from a second address
  std::uint64_t not_a_person = 0;     ///< (d) tracked objects: a character without 23 body segments
  std::uint64_t refused_pinned = 0;   ///< (d) UpperBody / No-Level streams
  std::uint64_t refused_bones = 0;    ///< (d) of samples with a bone off by more than 10 cm, or no possible body

  std::uint64_t frames = 0;        ///< whole samples handed on
  std::uint64_t incomplete = 0;    ///< samples of which a datagram never came
  std::uint64_t lost_samples = 0;  ///< gaps of the sample counter
  std::uint64_t restarts = 0;      ///< of the counter, or of the stream from another port, sender or character
  std::uint64_t clock_jumps = 0;   ///< the time code and the counter disagreed
  std::uint64_t jumps = 0;         ///< the body moved as no body can: the suit's origin or axes were reset
  std::uint64_t odd_bones = 0;     ///< samples whose bone lengths disagree with those before, handed on or not

  [[nodiscard]] std::uint64_t accounted() const;
};

/// Bytes to whole, checked, ordered SuitFrames of one wearer. `arrival_s` is any steady clock (capture time, or a
/// monotonic clock): the assembler asks for no clock itself. Deterministic. Not thread-safe.
class Assembler {
 public:
  using FrameSink = std::function<void(const SuitFrame&)>;

  explicit Assembler(const AssemblerConfig& config);
  ~Assembler();
  Assembler(Assembler&&) noexcept;
  Assembler& operator=(Assembler&&) noexcept;

  /// Takes one datagram; calls `sink` for each frame that becomes whole and due.
  void add(std::span<const std::byte> datagram, double arrival_s, std::string_view sender, const FrameSink& sink);

  /// No more datagrams (end of a recording): hands on what still waits.
  void flush(const FrameSink& sink);

  [[nodiscard]] const AssemblerStats& stats() const;
  [[nodiscard]] const WearerInfo& wearer() const;
  /// Grows whenever wearer() changes.
  [[nodiscard]] std::uint64_t wearer_revision() const;
  /// Samples per second as the stream has it (60–240); 0 while unknown.
  [[nodiscard]] double rate_hz() const;
  /// Set while the stream cannot be mapped (UpperBody or No-Level scenario, no whole body): says what to change in MVN.
  [[nodiscard]] const std::optional<std::string>& refusal() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
