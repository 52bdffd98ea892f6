// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace kinemap {

/// When a sample was taken, as its sender says (three clocks, none to be trusted alone).
struct SampleClock {
  std::int64_t index = 0;          ///< sample counter, unwrapped
  std::uint32_t time_code_ms = 0;  ///< wraps at midnight when live; may jump
  double arrival_s = 0.0;
};

/// Stream time out of counter and time code. The counter gives the spacing (it is exact), the time code gives the rate
/// and keeps the sum right in the long run (it has 1 ms steps). Time never decreases, whatever comes in.
class Timeline {
 public:
  struct Stamp {
    double time_s = 0.0;
    bool clock_jumped = false;  ///< the time code disagrees with the counter: one of them jumped
  };

  /// Learns the rate from samples that have not been stamped yet, in order. More samples, better rate; harmless when
  /// unusable.
  void prime(std::span<const SampleClock> samples);
  /// Stamps the next sample; `index` must grow from call to call except after `restart`.
  Stamp stamp(const SampleClock& sample);
  /// The counter starts anew: the next sample comes as much later as its arrival says, and at least one period.
  void restart();

  /// Counter steps per second; 0 while unknown.
  [[nodiscard]] double rate_hz() const { return rate_hz_; }

 private:
  void learn(const SampleClock& sample);
  void adopt(double measured_hz, double tolerance);
  [[nodiscard]] double follow(double step_s);

  double rate_hz_ = 0.0;
  double time_s_ = 0.0;
  double code_time_s_ = 0.0;  ///< what the time code alone would say
  std::optional<SampleClock> last_;
  bool restarted_ = false;
  std::deque<SampleClock> marks_;  ///< about one a second over the last seconds, time codes agreeing with counters
};

/// `b` − `a` in seconds; across midnight when that is what it looks like.
double time_code_step_s(std::uint32_t a, std::uint32_t b);

}  // namespace kinemap
