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
  int character = -1;               ///< which character is mapped; −1: the first that streams a whole body
  double reorder_window_s = 0.05;   ///< a sample waits so long (stream or arrival time) for missing datagrams and for older samples
  double restart_silence_s = 0.75;  ///< a counter that jumps back counts as a restart after this much silence
};

/// Every datagram ends in exactly one of these counters.
struct AssemblerStats {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;
  std::array<std::uint64_t, mxtp::kFaultCount> faults{};
  std::uint64_t frames = 0;              ///< whole samples handed on
  std::uint64_t skipped_types = 0;       ///< known types that are not used
  std::uint64_t meta = 0;                ///< types 12, 13, 24, 25 used
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;                ///< came after a newer sample had been handed on
  std::uint64_t incomplete = 0;          ///< samples of which a datagram never came
  std::uint64_t lost_samples = 0;        ///< gaps of the sample counter
  std::uint64_t other_character = 0;     ///< another wearer
  std::uint64_t other_sender = 0;        ///< the same character from a second address
  std::uint64_t not_a_person = 0;        ///< tracked objects: a character without 23 body segments
  std::uint64_t refused_pinned = 0;      ///< UpperBody / No-Level streams
  std::uint64_t restarts = 0;
  std::uint64_t odd_bones = 0;           ///< samples whose bone lengths disagree with those before
};

/// Bytes to whole, checked, ordered SuitFrames of one wearer. `arrival_s` is any steady clock (capture time, or a monotonic clock): the
/// assembler asks for no clock itself. Deterministic. Not thread-safe.
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
